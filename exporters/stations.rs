//! The stations that a survey names as a table: `stations.csv`, in the package of every target. Formats without frames have no
//! other place for them, and those with frames have not more than [`MOST_FRAMES`](crate::scene::MOST_FRAMES).

use crate::error::ExportError;
use crate::frame::micro;
use crate::package::Package;
use crate::scene::{Landmark, Scene};

/// Name of the file.
pub const STATIONS: &str = "stations.csv";

/// Writes the file, if the survey names a station: the name as a frame, that of the survey, and the place in the frame of the
/// manifest. Names of the survey are quoted as in RFC 4180.
///
/// # Errors
/// Those of the package.
pub fn write(scene: &Scene, out: &mut dyn Package) -> Result<(), ExportError> {
    let named = scene.network.named();
    if named.is_empty() {
        return Ok(());
    }
    out.write(STATIONS, |file| {
        writeln!(file, "frame,name,x_m,y_m,z_m")?;
        for Landmark { frame, label, position, .. } in named {
            let (name, [x, y, z]) = (label.replace('"', "\"\""), <[f64; 3]>::from(position).map(micro));
            writeln!(file, "{frame},\"{name}\",{x},{y},{z}")?;
        }
        Ok(())
    })
}

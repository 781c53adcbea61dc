//! Dripstone: where it hangs, and what stands below it.

use nalgebra::{Point3, Vector3};

use super::facets::Hit;
use super::kind::{Hang, Heading, KindRow, Place};
use super::library::Prototype;
use super::lots::Lots;
use super::place::{Candidate, Site, quantised, without_overlaps};
use plume_graph::Aabb;

/// Flattest ceiling or floor to which dripstone clings: upward component of its normal.
const CLINGING: f64 = 0.45;
/// Furthest that drops fall onto a stalagmite, in metres: further, a chunk may know one end and not the other.
const FURTHEST_FALL_M: f64 = 6.0;

impl<'a> Site<'a> {
    /// What hangs from the ceiling in these bounds, without overlaps, and what stands or stood below it.
    pub fn dripstone(&self, around: Aabb<f64>) -> Vec<Candidate<'a>> {
        let mut all = Vec::new();
        for row in self.rows() {
            if let Place::Ceiling(hang) = row.place {
                let hanging = self.hanging(row, hang, around);
                let roots: Vec<Candidate> = hanging.iter().map(|drip| drip.candidate.clone()).collect();
                let (apart, rooted) = (without_overlaps(&roots), self.rooted(&roots));
                for (_, drip) in hanging.into_iter().enumerate().filter(|(n, _)| apart[*n] && rooted[*n]) {
                    all.extend(self.grown(drip, hang));
                }
            }
        }
        self.push_in(all.iter_mut().filter(|candidate| matches!(candidate.row.place, Place::UnderDrip)).collect());
        let rooted = self.rooted(&all);
        all.into_iter().zip(rooted).filter(|(_, rooted)| *rooted).map(|(candidate, _)| candidate).collect()
    }

    fn hanging(&self, row: KindRow<'a>, hang: Hang, around: Aabb<f64>) -> Vec<Drip<'a>> {
        let side_m = 1.0 / hang.per_m2.sqrt();
        let mut found = Vec::new();
        for (mut lots, x, y) in self.cells(&row, side_m, around) {
            let there = lots.unit();
            let (length, any_rad) = (lots.normal(), std::f64::consts::TAU * lots.unit());
            let Some(prototype) = lots.one_of(self.setting.library.of(&row)) else { continue };
            let hits = self.walls.hits(x, y);
            let ceilings = hits.iter().enumerate().filter(|(_, hit)| hit.normal.z <= -CLINGING);
            let open = ceilings.map(|(n, ceiling)| (n.checked_sub(1).map(|below| hits[below]), *ceiling));
            let open = open.filter(|(floor, _)| floor.is_none_or(|floor| floor.normal.z > 0.0));
            for (floor, ceiling) in lots.one_per_storey(open, |(_, ceiling)| ceiling.z) {
                let floor = floor.filter(|floor| ceiling.z - floor.z < FURTHEST_FALL_M);
                let clearance_m = floor.map_or(f64::INFINITY, |floor| ceiling.z - floor.z);
                let length_m =
                    (hang.median_m * libm::exp(hang.sigma * length)).min(hang.longest_m).min(0.9 * clearance_m);
                let scale = quantised(length_m) / prototype.length_m();
                let at = Point3::new(x, y, ceiling.z);
                let embedding_m = prototype.sunk_m(scale, ceiling.normal);
                let candidate = Candidate {
                    id: lots.id(ceiling.z),
                    row,
                    prototype,
                    scale,
                    yaw_rad: match hang.heading {
                        Heading::Any => any_rad,
                        Heading::Joint => self.setting.field.drips().heading_rad(),
                        Heading::Slope => libm::atan2(-ceiling.normal.y, -ceiling.normal.x),
                    },
                    at,
                    embedding_m,
                    stands: false,
                    rank: scale,
                };
                found.push(Drip { candidate, floor, there, lots: lots.clone() });
            }
        }
        let at = |drip: &Drip| drip.candidate.at.map(|c| c as f32).into();
        let places: Vec<[f32; 3]> = found.iter().map(at).collect();
        let wetness = self.setting.field.drips().dripping(&places);
        let amount = self.settings.dripstone;
        let numbered = found.into_iter().enumerate();
        let mut wet: Vec<Drip> =
            numbered.filter(|(n, drip)| drip.there < amount * f64::from(wetness[*n])).map(|(_, drip)| drip).collect();
        self.push_in(wet.iter_mut().map(|drip| &mut drip.candidate).collect());
        wet
    }

    /// Moves ends of which a part is in the open further into the rock, where they are so by little.
    fn push_in(&self, candidates: Vec<&mut Candidate>) {
        let depths = self.depths(candidates.iter().map(|candidate| candidate.ends()).collect());
        for (candidate, depths) in candidates.into_iter().zip(depths) {
            let lacking_m = f64::from(WANTED_DEPTH_M - depths.into_iter().fold(f32::INFINITY, f32::min));
            let most_m = MOST_PUSH * candidate.scale * candidate.prototype.size_m.z;
            candidate.embedding_m += (lacking_m / CLINGING).clamp(0.0, most_m);
        }
    }

    /// A stalactite with its stalagmite, or their column; nothing if it leaves too little headroom.
    fn grown(&self, drip: Drip<'a>, hang: Hang) -> Vec<Candidate<'a>> {
        let Drip { candidate, floor, mut lots, .. } = drip;
        let Some(floor) = floor else { return vec![candidate] };
        let clearance_m = candidate.at.z - floor.z;
        let length_m = candidate.scale * candidate.prototype.length_m();
        let foot = Point3::new(candidate.at.x, candidate.at.y, floor.z);
        let is_low = clearance_m - length_m < self.settings.headroom_m;
        if is_low && self.corridor.is_within(foot, 0.3) {
            return Vec::new();
        }
        let (drips, height) = (lots.unit() < hang.dripping, lots.between(0.5, 1.7));
        if !drips || length_m < 0.08 || floor.normal.z < CLINGING {
            return vec![candidate];
        }
        let height_m = quantised((height * length_m).min(0.85 * clearance_m));
        let joins = length_m + height_m > 0.8 * clearance_m && clearance_m < MOST_COLUMN_M;
        let below = if joins {
            self.below(&mut lots, &Place::Joined, &candidate, floor, clearance_m)
        } else {
            self.below(&mut lots, &Place::UnderDrip, &candidate, floor, height_m)
        };
        match below {
            Some(column) if joins => vec![column],
            Some(stalagmite) => vec![candidate, stalagmite],
            None => vec![candidate],
        }
    }

    /// What stands below something that hangs, with this height.
    fn below(
        &self,
        lots: &mut Lots,
        place: &Place,
        hanging: &Candidate,
        floor: Hit,
        height_m: f64,
    ) -> Option<Candidate<'a>> {
        let row = self.rows().find(|row| std::mem::discriminant(&row.place) == std::mem::discriminant(place))?;
        let prototype = lots.one_of(self.setting.library.of(&row))?;
        let scale = height_m / prototype.height_m();
        let width_m = prototype.width_m() * scale;
        let foot = Point3::new(hanging.at.x, hanging.at.y, floor.z);
        if width_m < LEAST_STALAGMITE_M || self.corridor.is_within(foot, 0.6 * width_m) {
            return None;
        }
        let middle_m = if matches!(place, Place::Joined) { 0.5 * height_m } else { 0.0 };
        Some(Candidate {
            // Another one than that of what hangs above it.
            id: !hanging.id,
            row,
            prototype,
            scale,
            yaw_rad: std::f64::consts::TAU * lots.unit(),
            at: foot + Vector3::z() * middle_m,
            embedding_m: prototype.sunk_m(scale, floor.normal),
            stands: true,
            // Stones make room for it.
            rank: f64::INFINITY,
        })
    }

    /// Which of them have their ends in the rock all round.
    fn rooted(&self, candidates: &[Candidate]) -> Vec<bool> {
        let depths = self.depths(candidates.iter().map(Candidate::ends).collect());
        depths.iter().map(|ends| ends.iter().all(|depth| *depth > LEAST_DEPTH_M)).collect()
    }
}

/// Tallest column in metres: the hull of a taller one would be too far in the open.
const MOST_COLUMN_M: f64 = 2.0;
/// Least width of a stalagmite in metres (Curl, *Minimum diameter stalagmites*, 1973).
const LEAST_STALAGMITE_M: f64 = 0.03;

/// Something that hangs and may have a counterpart.
struct Drip<'a> {
    candidate: Candidate<'a>,
    floor: Option<Hit>,
    there: f64,
    lots: Lots,
}

/// Least depth of the rim of dripstone in the rock, in metres: the triangles of the wall are about a centimetre from the field.
const LEAST_DEPTH_M: f32 = 0.0;
/// How deep a rim is to be that is not deep enough by itself, in metres: deeper than the least, since surfaces bend.
const WANTED_DEPTH_M: f32 = 0.015;
/// How far it may be moved for that, as a share of its length; tuned by eye, what remains must not look cut off.
const MOST_PUSH: f64 = 0.2;

impl Candidate<'_> {
    /// Points on the rim of each end that is to be in the rock.
    fn ends(&self) -> Vec<[f32; 3]> {
        let thing = self.as_it_is();
        let middle = thing.pose.translation.vector;
        let corners = self.prototype.hull.corners.iter().map(|corner| thing.pose * (corner * self.scale));
        let half_m = 0.5 * self.prototype.size_m.z * self.scale;
        let is_end = |at: &Point3<f64>| match self.row.place {
            Place::Joined => (at.z - middle.z).abs() > 0.9 * half_m,
            Place::Ceiling(_) => at.z > middle.z,
            _ => at.z < middle.z,
        };
        corners.filter(is_end).map(|at| [at.x as f32, at.y as f32, at.z as f32]).collect()
    }
}

impl Prototype<'_> {
    /// How far it hangs below its origin, in metres.
    fn length_m(&self) -> f64 {
        -self.hull.corners.iter().map(|corner| corner.z).fold(f64::INFINITY, f64::min)
    }

    /// The height of what stands, in metres: a column is around its origin, and both its ends are in the rock.
    fn height_m(&self) -> f64 {
        match self.row.place {
            Place::Joined => 0.92 * self.size_m.z,
            _ => self.hull.corners.iter().map(|corner| corner.z).fold(0.0, f64::max),
        }
    }

    /// How far it is moved into a slope so that its whole root is in the rock, in metres.
    fn sunk_m(&self, scale: f64, normal: Vector3<f64>) -> f64 {
        /// How far roots reach beyond the origin.
        const ROOT_M: f64 = 0.036;
        let slope = normal.xy().norm() / normal.z.abs();
        (scale * (0.5 * self.size_m.x.max(self.size_m.y) * slope - ROOT_M)).max(0.0)
    }
}

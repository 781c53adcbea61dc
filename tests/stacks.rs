//! A rock that needs a large stack, as every rock does in a build without optimisation, is evaluated on threads that have one.
//! Where it is not, this test does not fail but aborts. `examples/program` shows the same with a compiler that does not optimise.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::collections::BTreeSet;
use std::hint::black_box;
use std::sync::Arc;

use plume::cave;
use plume::material::{BLOCK, CoarseBlock, DomainWarp, Footprint, Look, MATERIALS, MaterialRow, Sites, SurfaceSamples};
use plume::preview::{Format, Order, Pace, Size, Theme};
use plume::{Cave, CaveFolder, Input, Material, Observer, Recipe, Unobserved};
use schemars::JsonSchema;
use serde::Deserialize;
use serde_json::json;

/// Limestone that uses twice the stack that a thread has by default where it is seen.
#[derive(Debug, Deserialize, JsonSchema)]
struct Deep {}

fn deep<T>(work: impl FnOnce() -> T) -> T {
    let stack = black_box([1_u8; 4 << 20]);
    let done = work();
    black_box(&stack);
    done
}

/// From the table, because calling its type would compile the rock once more.
fn limestone() -> Arc<dyn Material> {
    (MATERIALS.find("limestone").unwrap().read)(json!({})).unwrap()
}

impl Material for Deep {
    fn domain_warp(&self) -> DomainWarp {
        limestone().domain_warp()
    }

    fn distances(&self, sites: &Sites, out: &mut [f32]) {
        limestone().distances(sites, out);
    }

    fn gradients(&self, sites: &Sites, out: &mut [[f32; 3]]) {
        limestone().gradients(sites, out);
    }

    fn coarse(&self, sites: &Sites, out: &mut CoarseBlock) {
        deep(|| limestone().coarse(sites, out));
    }

    fn surface_samples(
        &self,
        block: &CoarseBlock,
        look: &Look,
        footprint: Footprint,
        normals: &[[f32; BLOCK]; 3],
        out: &mut SurfaceSamples,
    ) {
        deep(|| limestone().surface_samples(block, look, footprint, normals, out));
    }
}

#[test]
fn rocks_are_evaluated_on_large_stacks() {
    MATERIALS.register(MaterialRow::new::<Deep>("deep", "limestone with a large stack")).unwrap();
    let settings = ["rock.kind=deep", "graph.nodes=3", "mesh.voxel_m=0.5", "texture.size_px=256"].map(str::to_owned);
    let input = || Input::of(Recipe::from_overrides(&settings).unwrap());
    let (home, watch) = (tempfile::tempdir().unwrap(), Unobserved::default());
    let folder = |name: &str| CaveFolder::open_or_new(&home.path().join(name)).unwrap();

    let made = Cave::make(input(), folder("cave"), false, &watch, &mut |_, _| ()).unwrap();
    assert!(made.chunk_names().count() > 0);
    let part = cave::make_part(&input(), &folder("part"), 0..1, &BTreeSet::from(cave::CHUNK_STAGES), false, &watch);
    assert_eq!(part.unwrap().len(), 1);
    let order = Order {
        format: Format::Png,
        theme: Theme::default(),
        size: Some(Size { width: 64, height: 36 }),
        at: None,
        look_rad: None,
        pace: Pace::default(),
        stop: watch.stop(),
    };
    cave::preview(&input(), cave::view_row("inside").unwrap(), &order, &watch).unwrap();
}

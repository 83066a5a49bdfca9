//! `ocellus explain`: what the scene calls for, and why.

use std::fmt::Write as _;

use ocellus_kernel::bvh::Node;
use ocellus_kernel::{Pixel, Real, View};
use serde_json::{Value, json};

use super::load;
use crate::assemble::{SetupReport, with_view};
use crate::cli::SceneArgs;
use crate::demand::{Demand, demands};
use crate::description::SceneDescription;
use crate::error::{Error, ExitCode};
use crate::kernels::{Row, TABLE, TableReal, select};
use crate::render::Precision;

pub(super) fn run(args: &SceneArgs) -> Result<ExitCode, Error> {
    let scene = load(args)?;
    let explanation = match args.precision {
        Precision::F32 => explain::<f32>(args, &scene)?,
        Precision::F64 => explain::<f64>(args, &scene)?,
    };
    if args.json {
        println!("{}", explanation.to_json());
    } else {
        print!("{}", explanation.to_text());
    }
    Ok(ExitCode::Done)
}

/// All that is known of a scene before it is rendered.
struct Explanation<'a> {
    args: &'a SceneArgs,
    scene: &'a SceneDescription,
    demands: Vec<Demand>,
    row: &'static Row,
    setup: SetupReport,
    bvh: Option<BvhFigures>,
    film_bytes: usize,
}

/// Figures of a hierarchy.
#[derive(Clone, Copy, Debug, Default)]
struct BvhFigures {
    nodes: usize,
    leaves: usize,
    deepest: usize,
    largest_leaf: usize,
    /// Expected node pairs and primitives that a random ray through the root box meets (surface area heuristic).
    expected_nodes: f64,
    expected_primitives: f64,
}

impl BvhFigures {
    fn of<R: Real>(nodes: &[Node<R>]) -> Self {
        let mut figures = Self { nodes: nodes.len(), ..Self::default() };
        let root_area = nodes.first().map_or(0.0, |root| root.bounds().half_area().to_f64());
        let mut waiting: Vec<(usize, usize)> = nodes.first().map(|_| (0, 0)).into_iter().collect();
        while let Some((at, depth)) = waiting.pop() {
            let node = &nodes[at];
            let share = if root_area > 0.0 { node.bounds().half_area().to_f64() / root_area } else { 1.0 };
            figures.deepest = figures.deepest.max(depth);
            if let Some(leaf) = node.leaf() {
                figures.leaves += 1;
                figures.largest_leaf = figures.largest_leaf.max(leaf.len());
                figures.expected_primitives += share * leaf.len() as f64;
            }
            if let Some(children) = node.children() {
                figures.expected_nodes += share;
                waiting.extend(children.map(|child| (child, depth + 1)));
            }
        }
        figures
    }
}

fn explain<'a, R: TableReal>(args: &'a SceneArgs, scene: &'a SceneDescription) -> Result<Explanation<'a>, Error> {
    with_view::<R, _>(scene, args.accel, |view: &View<'_, R>, setup| {
        Ok(Explanation {
            args,
            scene,
            demands: demands(scene),
            row: select(view.required_effects(), args.effects)?,
            setup: *setup,
            bvh: view.scene.bvh().map(|bvh| BvhFigures::of(bvh.nodes())),
            film_bytes: scene.film.width as usize * scene.film.height as usize * size_of::<Pixel>(),
        })
    })?
}

impl Explanation<'_> {
    fn to_text(&self) -> String {
        let mut text = String::new();
        // Writing to a string cannot fail.
        let _ = self.write_text(&mut text);
        text
    }

    fn write_text(&self, out: &mut String) -> std::fmt::Result {
        let (scene, film) = (self.scene, &self.scene.film);
        let triangles: usize = scene.meshes.iter().map(|mesh| mesh.triangles.len()).sum();
        writeln!(out, "scene    {}", self.args.scene.display())?;
        writeln!(
            out,
            "         {} spheres, {triangles} triangles, {} lights, {} materials, {} textures",
            self.setup.primitives - triangles,
            scene.lights.len(),
            scene.materials.len(),
            scene.textures.len(),
        )?;
        writeln!(out, "picture  {} x {} pixels, {} samples each", film.width, film.height, film.spp)?;
        writeln!(
            out,
            "kernel   {} in {}: {} of {} effects; {} kernels to choose from",
            self.row.name,
            self.args.precision,
            self.row.effects.len(),
            ocellus_kernel::Effects::ALL.len(),
            TABLE.len(),
        )?;

        writeln!(out, "\neffects that are on, and what asks for them")?;
        for demand in self.demands.iter().filter(|demand| !demand.origins.is_empty()) {
            let lines: Vec<String> = demand.origins.iter().take(3).map(ToString::to_string).collect();
            let more = demand.origins.len().saturating_sub(lines.len());
            let more = if more > 0 { format!(" and {more} more") } else { String::new() };
            writeln!(out, "  {:<15} {}{more}", demand.name, lines.join(", "))?;
        }
        let off: Vec<&str> =
            self.demands.iter().filter(|demand| demand.origins.is_empty()).map(|demand| demand.name).collect();
        if !off.is_empty() {
            writeln!(out, "effects that are off: {}", off.join(", "))?;
        }

        writeln!(out, "\nacceleration: {}", self.args.accel)?;
        if let Some(bvh) = &self.bvh {
            writeln!(
                out,
                "  {} nodes, {} leaves of at most {} primitives, depth {}",
                bvh.nodes, bvh.leaves, bvh.largest_leaf, bvh.deepest
            )?;
            writeln!(
                out,
                "  a random ray through it meets {:.1} inner nodes and {:.1} primitives of {}",
                bvh.expected_nodes, bvh.expected_primitives, self.setup.primitives
            )?;
        }
        let bytes = [
            ("scene", self.setup.scene_bytes),
            ("textures", self.setup.texture_bytes),
            ("hierarchy", self.setup.bvh_bytes),
            ("film", self.film_bytes),
        ];
        writeln!(out, "\nmemory while rendering")?;
        for (what, bytes) in bytes {
            writeln!(out, "  {what:<10} {:>10}", readable(bytes))?;
        }
        Ok(())
    }

    fn to_json(&self) -> Value {
        let effects: Value = self
            .demands
            .iter()
            .map(|demand| {
                let lines: Vec<String> = demand.origins.iter().map(ToString::to_string).collect();
                (demand.name.to_owned(), json!(lines))
            })
            .collect::<serde_json::Map<_, _>>()
            .into();
        json!({
            "scene": self.args.scene.display().to_string(),
            "precision": self.args.precision.to_string(),
            "kernel": self.row.name,
            "kernel_effects": self.row.effects.names().collect::<Vec<_>>(),
            "effects": effects,
            "primitives": self.setup.primitives,
            "accel": self.args.accel.to_string(),
            "bvh": self.bvh.map(|bvh| json!({
                "nodes": bvh.nodes,
                "leaves": bvh.leaves,
                "largest_leaf": bvh.largest_leaf,
                "depth": bvh.deepest,
                "expected_nodes": bvh.expected_nodes,
                "expected_primitives": bvh.expected_primitives,
            })),
            "scene_bytes": self.setup.scene_bytes,
            "texture_bytes": self.setup.texture_bytes,
            "bvh_bytes": self.setup.bvh_bytes,
            "film_bytes": self.film_bytes,
        })
    }
}

/// Bytes as people read them.
fn readable(bytes: usize) -> String {
    match bytes {
        0..1024 => format!("{bytes} B"),
        1024..1_048_576 => format!("{:.1} KiB", bytes as f64 / 1024.0),
        _ => format!("{:.1} MiB", bytes as f64 / 1_048_576.0),
    }
}

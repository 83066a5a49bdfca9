//! `ocellus explain`: what the scene calls for, and why.

use std::fmt::Write as _;

use ocellus_kernel::bvh::{Bounds, Branch, Bvh, Child};
use ocellus_kernel::{Effects, Pixel, Real, View};
use serde_json::{Value, json};

use super::streams::print;
use super::words::{bytes, counted, wrapped};
use super::{load, origins};
use crate::accuracy::describe;
use crate::assemble::{SetupReport, with_view};
use crate::cli::SceneArgs;
use crate::demand::{Demand, demands};
use crate::description::SceneDescription;
use crate::error::{Error, ExitCode};
use crate::isa::Isa;
use crate::kernels::{Row, TABLE, TableReal, select};
use crate::render::Precision;

pub(super) fn run(args: &SceneArgs) -> Result<ExitCode, Error> {
    let scene = load(args)?;
    let explanation = match args.precision {
        Precision::F32 => explain::<f32>(args, &scene)?,
        Precision::F64 => explain::<f64>(args, &scene)?,
    };
    if args.json {
        print(explanation.to_json())?;
    } else {
        print(explanation.to_text().trim_end())?;
    }
    Ok(ExitCode::Done)
}

/// Columns of the text, so that it fits a narrow terminal.
const WIDTH: usize = 100;

/// All that is known of a scene before it is rendered.
struct Explanation<'a> {
    args: &'a SceneArgs,
    scene: &'a SceneDescription,
    demands: Vec<Demand>,
    row: &'static Row,
    isa: Isa,
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
    /// Expected nodes and primitives of leaves that a random ray through the outermost box meets (surface area heuristic).
    expected_nodes: f64,
    expected_primitives: f64,
}

impl BvhFigures {
    fn of<R: Real>(bvh: &Bvh<'_, R>) -> Self {
        let mut figures = Self { nodes: bvh.nodes().len(), ..Self::default() };
        let Some(root) = bvh.nodes().first() else { return figures };
        // Of the rays that meet the box of a node, its child's share.
        let area = |bounds: Bounds<R>| bounds.half_area().to_f64();
        let around = bvh.children(root).map(|branch| branch.bounds).reduce(|a, b| a.union(&b));
        let root_area = around.map_or(0.0, area);
        let mut waiting = vec![(root, 0, 1.0)];
        while let Some((node, depth, share)) = waiting.pop() {
            figures.expected_nodes += share;
            figures.deepest = figures.deepest.max(depth);
            for Branch { bounds, primitives, child } in bvh.children(node) {
                let share = if root_area > 0.0 { area(bounds) / root_area } else { 1.0 };
                if let Child::Node(child) = child {
                    waiting.push((&bvh.nodes()[child], depth + 1, share));
                } else {
                    figures.leaves += 1;
                    figures.largest_leaf = figures.largest_leaf.max(primitives);
                    figures.expected_primitives += share * primitives as f64;
                }
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
            row: select(view.required_effects(), args.effects, args.accuracy.into())?,
            isa: Isa::select(args.isa)?,
            setup: *setup,
            bvh: view.scene.bvh().map(BvhFigures::of),
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
        let parts = [
            (scene.spheres.len(), "sphere"),
            (triangles, "triangle"),
            (scene.lights.len(), "light"),
            (scene.materials.len(), "material"),
            (scene.textures.len(), "texture"),
        ];
        let parts: Vec<_> =
            parts.iter().filter(|part| part.0 > 0).map(|&(count, noun)| counted(count as u64, noun)).collect();
        writeln!(out, "scene    {}", self.args.scene.display())?;
        writeln!(out, "         {}", parts.join(", "))?;
        writeln!(
            out,
            "picture  {} x {} pixels, {} each, up to {}",
            film.width,
            film.height,
            counted(film.spp.into(), "sample"),
            counted(scene.integrator.max_bounces.into(), "bounce"),
        )?;
        let on = self.demands.iter().filter(|demand| !demand.origins.is_empty()).count();
        let (has, all) = (self.row.effects.len() as usize, TABLE.len());
        let needed = if on == has { "all needed".to_owned() } else { format!("{on} needed") };
        writeln!(
            out,
            "kernel   {} in {}, {} ({needed}); one of {all} kernels; {}",
            self.row.name,
            self.args.precision,
            counted(has as u64, "effect"),
            self.isa,
        )?;
        writeln!(out, "accuracy {}", describe(self.row.accuracy))?;

        writeln!(out, "\neffects that are on, and the lines that ask for them")?;
        for demand in self.demands.iter().filter(|demand| !demand.origins.is_empty()) {
            let mut name = demand.name;
            // The triangles of a bare mesh are its own, and a sampler the command line's; all else that no line asks for
            // was chosen for it.
            let is_asked = Effects::TRIANGLES.union(Effects::SOBOL).contains(demand.effect);
            let whole = if is_asked { "" } else { " (by default)" };
            for lines in origins::layout(&demand.origins, whole, WIDTH - 18) {
                writeln!(out, "  {name:<15} {lines}")?;
                name = "";
            }
        }
        let off: Vec<&str> =
            self.demands.iter().filter(|demand| demand.origins.is_empty()).map(|demand| demand.name).collect();
        if !off.is_empty() {
            writeln!(out, "effects that are off")?;
        }
        for line in wrapped(&off, WIDTH - 2) {
            writeln!(out, "  {line}")?;
        }

        writeln!(out, "\nacceleration: {}", self.args.accel)?;
        if let Some(bvh) = &self.bvh {
            writeln!(
                out,
                "  {}, {} of at most {}, depth {}",
                counted(bvh.nodes as u64, "node"),
                if bvh.leaves == 1 { "1 leaf".to_owned() } else { format!("{} leaves", bvh.leaves) },
                counted(bvh.largest_leaf as u64, "primitive"),
                bvh.deepest
            )?;
            writeln!(
                out,
                "  a random ray through it meets {:.1} nodes and {:.1} primitives of {}",
                bvh.expected_nodes, bvh.expected_primitives, self.setup.primitives
            )?;
        }
        let sizes = [
            ("scene", self.setup.scene_bytes),
            ("textures", self.setup.texture_bytes),
            ("hierarchy", self.setup.bvh_bytes),
            ("film", self.film_bytes),
        ];
        writeln!(out, "\nmemory while rendering")?;
        for (what, size) in sizes.into_iter().filter(|(_, size)| *size > 0) {
            writeln!(out, "  {what:<10} {:>10}", bytes(size))?;
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
            "accuracy": describe(self.row.accuracy),
            "isa": self.isa.to_string(),
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

//! What the compiler made of the kernels: an effect outside of a kernel's set leaves no instruction behind, and no
//! multiplication is fused with an addition.
//!
//! The test disassembles its own program. From the address of a kernel in the host's table it follows every call,
//! and asks the line tables from which source file and function each instruction comes, inlined ones included.

use std::collections::{BTreeMap, BTreeSet};

use addr2line::Loader;
use iced_x86::{Decoder, DecoderOptions, Instruction};
use object::{Object, ObjectSection, ObjectSymbol, SymbolKind};
use ocellus::isa::Isa;
use ocellus::kernels::{ALTERNATIVES, Row, TABLE, TableReal};

use crate::support::trials::Trials;

/// Source files and functions that code can come from, by the effect that they belong to.
const TRACES: [(&str, &str); 11] = [
    ("glass", "kernel/src/material/dielectric.rs"),
    ("glass", "kernel/src/material/fresnel.rs"),
    ("mirror", "kernel/src/material/mirror.rs"),
    ("textures", "kernel/src/texture.rs"),
    ("triangles", "kernel/src/shape/triangle.rs"),
    ("sphere-light", "kernel/src/light/sphere.rs"),
    ("point-light", "kernel/src/light/point.rs"),
    ("lens", "kernel/src/warp.rs disk"),
    ("filter", "kernel/src/warp.rs gaussian"),
    ("sobol", "kernel/src/sampler/sobol.rs"),
    ("aim", "kernel/src/aim.rs"),
];

/// This program, as its file says it.
struct Program {
    lines: Loader,
    /// Functions by address: size, demangled name, code.
    functions: BTreeMap<u64, (String, Vec<u8>)>,
    /// What is added to an address of the file to give one of the running program.
    load_offset: u64,
}

/// What the code that is reached from an address consists of.
#[derive(Default)]
struct Code {
    /// Every `file function` that it comes from.
    sources: BTreeSet<String>,
    mnemonics: BTreeSet<String>,
}

impl Program {
    fn this() -> Self {
        let path = std::env::current_exe().unwrap();
        let bytes = std::fs::read(&path).unwrap();
        let file = object::File::parse(&*bytes).unwrap();
        let mut functions = BTreeMap::new();
        for symbol in file.symbols().filter(|symbol| symbol.kind() == SymbolKind::Text && symbol.size() > 0) {
            let section = file.section_by_index(symbol.section_index().unwrap()).unwrap();
            let code = section.data_range(symbol.address(), symbol.size()).unwrap().unwrap_or_default();
            let name = addr2line::demangle_auto(symbol.name().unwrap().into(), None).into_owned();
            functions.insert(symbol.address(), (name, code.to_vec()));
        }
        let mapped = std::fs::read_to_string("/proc/self/maps").unwrap();
        let first = mapped.lines().find(|line| line.ends_with(path.to_str().unwrap())).unwrap();
        let load_offset = u64::from_str_radix(first.split('-').next().unwrap(), 16).unwrap();
        Self { lines: Loader::new(&path).unwrap(), functions, load_offset }
    }

    /// The code that is reached from `start`.
    fn code(&self, start: u64) -> Code {
        let mut found = Code::default();
        let mut seen = BTreeSet::from([start]);
        let mut waiting = vec![start];
        while let Some(address) = waiting.pop() {
            let (_, code) = &self.functions[&address];
            for instruction in Decoder::with_ip(64, code, address, DecoderOptions::NONE) {
                found.mnemonics.insert(format!("{:?}", instruction.mnemonic()).to_lowercase());
                let mut frames = self.lines.find_frames(instruction.ip()).unwrap();
                while let Some(frame) = frames.next().unwrap() {
                    let file = frame.location.and_then(|location| location.file).unwrap_or_default();
                    let function = frame.function.map(|function| function.demangle().unwrap().into_owned());
                    found.sources.insert(format!("{file} {}", function.unwrap_or_default()));
                }
                // 0 where the instruction is no direct call or jump.
                let target = instruction.near_branch_target();
                if self.functions.contains_key(&target) && seen.insert(target) && self.is_ours(target) {
                    waiting.push(target);
                }
            }
        }
        found
    }

    /// Whether a function has code of the kernel, by name or inlined: formatting and panics of the standard library do no
    /// work of it, but an iterator of the standard library may.
    fn is_ours(&self, address: u64) -> bool {
        let (name, code) = &self.functions[&address];
        let is_inlined = |instruction: Instruction| {
            let mut frames = self.lines.find_frames(instruction.ip()).unwrap();
            while let Some(frame) = frames.next().unwrap() {
                if frame.location.and_then(|location| location.file).is_some_and(|file| file.contains("kernel/src/")) {
                    return true;
                }
            }
            false
        };
        name.contains("ocellus")
            || Decoder::with_ip(64, code, address, DecoderOptions::NONE).into_iter().any(is_inlined)
    }

    /// The code of a row's kernel.
    fn kernel<R: TableReal>(&self, row: &Row, isa: Isa) -> Code {
        let code = self.code(R::kernels(row).of_isa(isa) as usize as u64 - self.load_offset);
        assert!(
            code.sources.iter().any(|source| source.contains("kernel/src/path.rs")),
            "{}, {isa}: not a kernel",
            row.name
        );
        code
    }
}

/// The effects whose code is found in a row's kernel.
fn traces<R: TableReal>(program: &Program, row: &Row, isa: Isa) -> BTreeSet<&'static str> {
    let sources = program.kernel::<R>(row, isa).sources;
    let found = |trace: &str| sources.iter().any(|source| source.contains(trace));
    TRACES.iter().filter(|(_, trace)| found(trace)).map(|(effect, _)| *effect).collect()
}

/// The instruction sets that there are kernels for.
const ALL: [Isa; 3] = [Isa::Baseline, Isa::Avx2, Isa::Avx512];

#[test]
fn kernels_hold_the_code_of_their_own_effects_and_no_other() {
    let program = Program::this();
    let all: BTreeSet<&str> = TRACES.iter().map(|(effect, _)| *effect).collect();
    for row in TABLE {
        let own: BTreeSet<&str> = row.effects.names().filter(|name| all.contains(name)).collect();
        println!("{}: code of {own:?} expected", row.name);
        for isa in ALL {
            assert_eq!(traces::<f32>(&program, row, isa), own, "{} in f32, {isa}", row.name);
            assert_eq!(traces::<f64>(&program, row, isa), own, "{} in f64, {isa}", row.name);
        }
    }
}

/// N10. A fused operation rounds once where the source says twice, and then edges of triangles may leak.
#[test]
fn no_kernel_fuses_operations() {
    let program = Program::this();
    let searched = Trials::of::<f32>("N10", "kernels without fused operations, both precisions");
    for (row, isa) in TABLE.iter().chain(ALTERNATIVES).flat_map(|row| ALL.map(|isa| (row, isa))) {
        for code in [program.kernel::<f32>(row, isa), program.kernel::<f64>(row, isa)] {
            assert!(code.mnemonics.iter().any(|name| name.contains("muls") || name.contains("mulp")));
            let fused: Vec<_> = code.mnemonics.iter().filter(|name| is_fused(name)).collect();
            searched.holds(fused.is_empty(), || format!("{}, {isa}: {fused:?}", row.name));
        }
    }
    assert!(["vfmadd213ss", "vfnmsub231pd", "vfmaddps"].into_iter().all(is_fused) && !is_fused("vmulps"));
    searched.end(60);
}

/// Whether it is one of the multiplications with an addition or a subtraction.
fn is_fused(mnemonic: &str) -> bool {
    ["vfm", "vfnm"].iter().any(|start| mnemonic.starts_with(start))
}

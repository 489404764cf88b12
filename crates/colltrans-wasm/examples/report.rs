//! Writes the report of an assembly as the command `assembly -o` does, for the test of its viewer.
//!
//! The arguments are a tolerance, the output file, and the parts. A single file may be a manifest; its first
//! part is then mapped too. If the output file is named `clashes.html`, it is the report of an audit instead, with a
//! clearance of 1.
//!
//! In `crates/colltrans-wasm`:
//! `cargo run --release --features report --example report -- 0.1 report.html *.off`

use std::error::Error;
use std::path::Path;

use colltrans_assembly::audit::{AuditOptions, audit};
use colltrans_assembly::map::{MapOptions, RemovalMap};
use colltrans_assembly::report::{clashes, html};
use colltrans_assembly::{AnalysisRequest, Assembly, Bodies, Fit, Part, Piece, Watch};
use colltrans_assembly_io::read::{ReadOptions, read};
use glam::DAffine3;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [tolerance, target, files @ ..] = &arguments[..] else {
        return Err("missing arguments; expected TOLERANCE OUTPUT FILES...".into());
    };
    let watch = Watch::default();
    let (assembly, is_manifest) = match files {
        [one] if Path::new(one).extension().is_some_and(|ending| ending == "json") => {
            (read(one, &ReadOptions::default())?, true)
        }
        _ => (assembly(files)?, false),
    };
    let bodies = Bodies::new(&assembly, Fit::Tolerance(tolerance.parse()?))?;
    if Path::new(target).file_name().is_some_and(|name| name == "clashes.html") {
        let options = AuditOptions::default().with_within(1.0)?;
        let found = audit(&bodies, &options, watch)?;
        return Ok(std::fs::write(
            target,
            clashes::clashes_page(&bodies, &options, &found, "parts", watch)?,
        )?);
    }
    let mut findings = AnalysisRequest::default().analyse(&bodies, watch)?;
    let name = assembly.parts()[0].name().to_owned();
    if is_manifest {
        let options = MapOptions::default().with_samples(42).with_border(0.1);
        findings.maps.push((name.clone(), RemovalMap::new(&bodies, &[0], &[], options, watch)?));
    }
    Ok(std::fs::write(
        target,
        html::report_page(&findings, if is_manifest { &name } else { "parts" }),
    )?)
}

fn assembly(files: &[String]) -> Result<Assembly, Box<dyn Error>> {
    let parts = files.iter().map(|file| {
        let mesh = colltrans_mesh::read(file)?;
        let name = Path::new(file).file_stem().unwrap_or_default().to_string_lossy();
        let piece = Piece { mesh, world_from_piece: DAffine3::IDENTITY };
        Ok(Part::new(name, &[piece])?)
    });
    Ok(Assembly::new(parts.collect::<Result<_, Box<dyn Error>>>()?)?)
}

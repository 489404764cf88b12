//! Lists the fasteners of assemblies as a table: `fasteners SOURCE...`. The last row of each source has the facets, the
//! visits of facets and vertices, and the share of the time of a plan that the recognition takes.

use std::error::Error;
use std::path::Path;
use std::time::Instant;

use colltrans_assembly::fasteners::Fasteners;
use colltrans_assembly::{AnalysisRequest, Bodies, Fit, Watch};
use colltrans_assembly_io::read::{self, ReadOptions};

fn main() -> Result<(), Box<dyn Error>> {
    println!("| source | part | recognised | details |\n|---|---|---|---|");
    for source in std::env::args().skip(1) {
        let assembly = read::read(Path::new(&source), &ReadOptions::default())?;
        let bodies = Bodies::new(&assembly, Fit::default_for(&assembly))?;
        let start = Instant::now();
        let found = Fasteners::with_holds(&bodies)?;
        let own = start.elapsed().as_secs_f64();
        AnalysisRequest::default().analyse(&bodies, Watch::default())?;
        let all = start.elapsed().as_secs_f64() - own;
        for (k, part) in assembly.parts().iter().enumerate() {
            let (title, details) =
                found.get(k).map_or_else(Default::default, |f| (f.title(), f.details()));
            println!("| {source} | {} | {title} | {details} |", part.name());
        }
        let facets: usize = assembly.parts().iter().map(|p| p.solid().triangles().len()).sum();
        let (work, share) = (found.work(), 100.0 * own / all);
        println!("| {source} | | {facets} facets, {work} visits | {share:.1} % of the plan |");
    }
    Ok(())
}

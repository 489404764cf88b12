//! Tests of the printed report: pages, pictures, print, and width on a phone.

use colltrans_testkit::TemporaryFolder;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::common::{cuboid, part, stud, well};
use colltrans_assembly::plan::{Plan, PlanOptions};
use colltrans_assembly::report::html;
use colltrans_assembly::{AnalysisRequest, Assembly, Bodies, Fit, Watch};

/// Computes a plan and its report.
fn plan_and_report(assembly: &Assembly, title: &str) -> (Plan, String) {
    let bodies = Bodies::new(assembly, Fit::default_for(assembly)).unwrap();
    let options = PlanOptions::default();
    let question = AnalysisRequest::default().with_options(options);
    let findings = question.analyse(&bodies, Watch::default()).unwrap();
    let page = html::report_page(&findings, title);
    (findings.plan, page)
}

/// Computes a plan and the instructions that put the assembly together.
fn instructions(assembly: &Assembly, title: &str) -> String {
    let bodies = Bodies::new(assembly, Fit::default_for(assembly)).unwrap();
    let findings = AnalysisRequest::default().analyse(&bodies, Watch::default()).unwrap();
    html::instructions_page(&findings, title)
}

/// Returns a core in a box with a lid, and four pegs on the lid.
fn boxed() -> Assembly {
    let mut parts = vec![
        part("box", &well([0.0; 3], [20.0, 20.0, 10.0], 2.0)),
        part("core", &[cuboid([4.0, 4.0, 0.0], [16.0, 16.0, 9.0])]),
        part("lid", &[cuboid([-2.0, -2.0, 10.0], [22.0, 22.0, 12.0])]),
    ];
    for (k, [x, y]) in [[0.0, 0.0], [16.0, 0.0], [0.0, 16.0], [16.0, 16.0]].into_iter().enumerate()
    {
        parts.push(part(&format!("peg_{k}"), &[cuboid([x, y, 12.0], [x + 3.0, y + 4.0, 17.0])]));
    }
    Assembly::new(parts).unwrap().with_unit("mm")
}

/// Returns a bar in a long tunnel that hides it from all sides.
fn tunnel() -> Assembly {
    let wall = |low, high| cuboid(low, high);
    let tunnel = [
        wall([-50.0, -4.0, -4.0], [50.0, -1.0, 4.0]),
        wall([-50.0, 1.0, -4.0], [50.0, 4.0, 4.0]),
        wall([-50.0, -4.0, -4.0], [50.0, 4.0, -1.0]),
        wall([-50.0, -4.0, 1.0], [50.0, 4.0, 4.0]),
    ];
    let bar = part("bar", &[cuboid([-3.0, -1.0, -1.0], [3.0, 1.0, 1.0])]);
    Assembly::new(vec![part("tunnel", &tunnel), bar]).unwrap()
}

/// Returns the section of a page with an id.
fn section<'a>(page: &'a str, id: &str) -> &'a str {
    let at = page.find(&format!("id=\"{id}\"")).unwrap_or_else(|| panic!("no {id}"));
    &page[at..at + page[at..].find("</section>").unwrap()]
}

/// Returns the pictures of a section.
fn pictures(section: &str) -> Vec<&str> {
    let from = section.match_indices("<svg").map(|(at, _)| &section[at..]);
    from.map(|text| &text[..text.find("</svg>").unwrap()]).collect()
}

/// Returns the area in pixels of a part drawn in a style. Its tiles are rectangles `M x y h width v height h
/// -width z`.
fn drawn_area(picture: &str, look: &str, part: usize) -> f64 {
    let mut area = 0.0;
    let head = format!("<g class=\"{look}\" data-part=\"{part}\">");
    for (at, _) in picture.match_indices(&head) {
        let group = &picture[at..at + picture[at..].find("</g>").unwrap()];
        // Lines are not filled.
        for path in group.split("<path ").skip(1).filter(|path| !path.contains("fill=\"none\"")) {
            let data = path.split(" d=\"").nth(1).unwrap().split('"').next().unwrap();
            for tile in data.split('h').skip(1).filter(|tile| tile.contains('v')) {
                let (width, height) = tile.split_once('v').unwrap();
                area += width.parse::<f64>().unwrap() * height.parse::<f64>().unwrap();
            }
        }
    }
    area
}

/// Returns the text of a page without styles, scripts and pictures, with the labels of the pictures.
fn page_text(page: &str) -> String {
    let mut text = page.to_owned();
    for [from, to] in [["<style>", "</style>"], ["<script", "</script>"], ["<svg", "</svg>"]] {
        while let Some(at) = text.find(from) {
            let end = at + text[at..].find(to).unwrap() + to.len();
            let label = text[at..end].split("aria-label=\"").nth(1);
            let label = label.map(|rest| format!("[{}]", rest.split('"').next().unwrap()));
            text.replace_range(at..end, &label.unwrap_or_default());
        }
    }
    for tag in ["h1", "h2", "h3", "p", "li", "dt", "tr", "figcaption", "div", "summary", "section"]
    {
        text = text.replace(&format!("<{tag}"), &format!("\n<{tag}"));
    }
    for tag in ["td", "th", "dd", "span"] {
        text = text.replace(&format!("<{tag}"), &format!(" <{tag}"));
    }
    let (mut plain, mut inside) = (String::new(), false);
    for c in text.chars() {
        match c {
            '<' => inside = true,
            '>' => inside = false,
            c if !inside => plain.push(c),
            _ => (),
        }
    }
    let lines = plain.lines().map(|line| line.split_whitespace().collect::<Vec<_>>().join(" "));
    lines.filter(|line| !line.is_empty()).collect::<Vec<_>>().join("\n") + "\n"
}

#[test]
fn each_stage_has_page_with_visible_moving_parts() {
    for (assembly, stages) in [(boxed(), 3), (tunnel(), 1), (stud(), 1)] {
        let (plan, page) = plan_and_report(&assembly, "small");
        assert_eq!(plan.stages().len(), stages, "{:?}", plan.steps);
        assert_eq!(page.matches("class=\"sheet step\"").count(), stages);
        for stage in plan.stages() {
            let sheet = section(&page, &format!("step-{}", stage.start + 1));
            let drawn = pictures(sheet);
            let legs: Vec<&[usize]> = match &plan.steps[stage.start].path[..] {
                [_] => plan.steps[stage.clone()].iter().map(|step| &step.parts[..]).collect(),
                path => path.iter().map(|leg| &leg.parts[..]).collect(),
            };
            let several = plan.steps[stage.start].path.len() > 1;
            // The first picture shows the place in the whole.
            let (place, drawn) = drawn.split_first().unwrap();
            assert_eq!(drawn.len(), if several { legs.len() } else { 1 });
            let coloured = |part: &usize| drawn_area(place, "moving", *part) > 0.0;
            assert!(plan.steps[stage.start].parts.iter().all(coloured), "{stage:?}");
            for (k, moving) in legs.into_iter().enumerate() {
                let picture = drawn[if several { k } else { 0 }];
                let seen: f64 =
                    moving.iter().map(|&part| drawn_area(picture, "moving", part)).sum();
                assert!(seen > 100.0, "{moving:?} of {stage:?}: {seen}");
            }
        }
    }
}

#[test]
fn only_parts_that_hide_moving_parts_are_glass() {
    let (_, page) = plan_and_report(&tunnel(), "tunnel");
    let [_, picture] = pictures(section(&page, "step-1"))[..] else { panic!("two pictures") };
    assert!(drawn_area(picture, "glass", 0) > 1000.0 && drawn_area(picture, "pale", 0) == 0.0);
    assert!(section(&page, "step-1").contains("Drawn as glass: tunnel."));
    let (_, page) = plan_and_report(&boxed(), "box");
    let drawn = (1..=6).filter(|k| page.contains(&format!("id=\"step-{k}\"")));
    for step in drawn {
        let picture = pictures(section(&page, &format!("step-{step}")))[1];
        assert!(!picture.contains("class=\"glass\""), "{step}");
    }
}

#[test]
fn first_page_shows_all_parts_and_lists_shapes() {
    let (_, page) = plan_and_report(&boxed(), "box");
    let cover = section(&page, "cover");
    let [picture] = pictures(cover)[..] else { panic!("one picture") };
    for part in 0..7 {
        assert!(drawn_area(picture, "full", part) > 50.0, "{part}");
    }
    assert_eq!(cover.matches("<li>").count(), 4, "four shapes");
}

/// The moves of instructions are those of the plan, reversed.
#[test]
fn instructions_reverse_steps_and_moves() {
    let page = instructions(&boxed(), "box");
    let headings: Vec<&str> =
        page.split("<h2>").skip(1).map(|rest| rest.split("</h2>").next().unwrap()).collect();
    let steps: Vec<&&str> = headings.iter().filter(|text| text.starts_with("Step")).collect();
    assert_eq!(
        steps,
        [&"Step 1: put in core", &"Step 2: put in lid", &"Steps 3–6: put in 4 × peg"]
    );
    let lid = page_text(section(&page, "step-2"));
    assert!(lid.contains("Direction down (−z)") && lid.contains("Needs step 1\n"), "{lid}");
    assert!(lid.contains("Round 2 of 3"), "{lid}");
    let [_, core] = pictures(section(&page, "step-1"))[..] else { panic!("two pictures") };
    assert!(drawn_area(core, "moving", 1) > 100.0 && drawn_area(core, "pale", 0) > 100.0);
    assert!(!core.contains("data-part=\"2\""), "the lid is not there yet");
    let text = page_text(&instructions(&stud(), "stud"));
    let moves = [
        "1. stud: down (−z), 8.",
        "2. stud: towards the front (−y), 2.",
        "3. stud: towards the left (−x), 9.",
        "4. stud: up (+z), 4.",
    ];
    let places = moves.map(|text_of_move| text.find(text_of_move).expect(text_of_move));
    assert!(places.is_sorted(), "{text}");
}

/// Numbers of the report are written as on a drawing, also if the files are in metres.
#[test]
fn report_has_no_exponents() {
    let small = |name: &str, low: f64, high: f64| {
        part(name, &[cuboid([0.0, 0.0, low], [0.000_625, 0.012, high])])
    };
    let parts = vec![small("a", 0.0, 0.000_625), small("b", 0.000_625, 0.001_25)];
    let assembly = Assembly::new(parts).unwrap().with_unit("m");
    let text = page_text(&plan_and_report(&assembly, "small").1);
    let is_exponent = |at: usize| {
        let (before, after) = (&text[..at], &text[at + 1..]);
        before.ends_with(|c: char| c.is_ascii_digit())
            && after.trim_start_matches('-').starts_with(|c: char| c.is_ascii_digit())
    };
    let found: Vec<usize> =
        text.match_indices('e').map(|(at, _)| at).filter(|&at| is_exponent(at)).collect();
    assert_eq!(found, [0; 0], "{text}");
    assert!(text.contains("0.62 × 12 × 1.25 mm overall"), "{text}");
    assert!(text.contains("4.688 mm³"), "{text}");
}

/// Compares the text with a golden file. Inspect the page before updating the file.
#[test]
fn report_text_matches_golden_file() {
    let mut text = page_text(&plan_and_report(&boxed(), "box").1);
    text += &page_text(&plan_and_report(&stud(), "stud").1);
    let golden_path =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../colltrans-assembly/tests/golden/report.txt");
    if std::env::var_os("WRITE_GOLDEN").is_some() {
        std::fs::write(&golden_path, &text).unwrap();
    }
    let known = std::fs::read_to_string(golden_path).unwrap();
    for (k, (found, known)) in text.lines().zip(known.lines()).enumerate() {
        assert_eq!(found, known, "line {}", k + 1);
    }
    assert_eq!(text.lines().count(), known.lines().count());
}

/// Runs an installed Chromium on a page; `None` if there is none.
fn chromium(folder: &Path, arguments: &[&str], page: &Path) -> Option<std::process::Output> {
    let known = ["chromium", "chromium-browser", "google-chrome"];
    let paths = std::env::var_os("PATH").unwrap_or_default();
    let find = |name| std::env::split_paths(&paths).map(move |folder: PathBuf| folder.join(name));
    let program = known.into_iter().flat_map(find).find(|path| path.is_file())?;
    let profile = format!("--user-data-dir={}", folder.join("profile").display());
    let plain = ["--headless", "--no-sandbox", "--disable-gpu", &profile];
    let output = Command::new(program).args(plain).args(arguments).arg(page).output().unwrap();
    Some(output)
}

#[test]
fn printed_report_has_one_page_for_each_run_of_like_stages() {
    let folder = TemporaryFolder::new();
    for (name, assembly) in [("box", boxed()), ("stud", stud())] {
        let (plan, page) = plan_and_report(&assembly, name);
        let (html, pdf) = (folder.path().join("report.html"), folder.path().join("report.pdf"));
        std::fs::write(&html, page).unwrap();
        let print = format!("--print-to-pdf={}", pdf.display());
        let Some(said) = chromium(folder.path(), &["--no-pdf-header-footer", &print], &html) else {
            eprintln!("skipped: no Chromium");
            return;
        };
        let bytes = std::fs::read(&pdf).unwrap_or_else(|e| panic!("{e}: {said:?}"));
        let pages = bytes.windows(12).filter(|w| w.starts_with(b"/Type /Page") && w[11] != b's');
        // The first page, the bill of materials, one for each run of like stages, and one for the sections after
        // them. All three stages of the box lead upwards.
        assert_eq!(plan.stages().len(), if name == "box" { 3 } else { 1 });
        assert_eq!(pages.count(), 2 + 1 + 1, "{name}");
    }
}

#[test]
fn report_fits_width_of_phone() {
    let folder = TemporaryFolder::new();
    let page = plan_and_report(&boxed(), "box").1;
    let measure = "<script>document.documentElement.style.width = '390px';
        for (const d of document.querySelectorAll('details')) d.open = true;
        const wide = [...document.querySelectorAll('body, main, section, details, figure, svg, p, ol, li, dl, div, h1, h2, h3')]
            .filter((e) => !e.parentElement.closest('.wide, svg') && e.getBoundingClientRect().right > 390.5);
        document.title = 'too wide: ' + wide.map((e) => e.tagName + '.' + e.className).join(' ');</script>";
    let html = folder.path().join("report.html");
    std::fs::write(&html, page.replace("</body>", &format!("{measure}</body>"))).unwrap();
    if let Some(said) = chromium(folder.path(), &["--dump-dom"], &html) {
        let document = String::from_utf8_lossy(&said.stdout);
        assert!(document.contains("<title>too wide: </title>"), "{:?}", document.get(..600));
    }
}

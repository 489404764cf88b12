//! The long texts of `--help`, filled into lines that fit the terminal.

use colltrans_mesh::Format;

/// Lines are no longer than this, however wide the terminal is.
pub(super) const WIDEST: usize = 100;

/// Columns of the terminal, as clap finds them too.
fn columns() -> usize {
    let terminal = terminal_size::terminal_size().map(|(width, _)| usize::from(width.0));
    let columns = || std::env::var("COLUMNS").ok()?.parse().ok();
    terminal.or_else(columns).filter(|c| *c > 0).unwrap_or(WIDEST).min(WIDEST)
}

/// Texts one below the other, filled into the terminal's columns.
pub(super) fn fitted(texts: &[&str]) -> String {
    let width = columns();
    texts.iter().map(|text| filled(text, width)).collect::<Vec<_>>().join("\n\n")
}

/// A text whose paragraphs are filled anew where lines are longer than `width`.
fn filled(text: &str, width: usize) -> String {
    let mut out: Vec<String> = Vec::new();
    let mut lines = text.lines().peekable();
    while let Some(first) = lines.next() {
        let hang = hang(first);
        let mut words = vec![first.to_owned()];
        let mut last = first;
        while let Some(next) = lines.next_if(|next| continues(last, next, hang)) {
            words.push(next.trim_start().to_owned());
            last = next;
        }
        let fits = |line: &String| line.chars().count() <= width;
        if words.len() == 1 && fits(&words[0]) {
            out.push(first.to_owned());
        } else {
            fill(&words.join(" "), hang, is_command(first), width, &mut out);
        }
    }
    out.join("\n")
}

fn is_command(line: &str) -> bool {
    line.starts_with("    ") && line.contains("colltrans ")
}

fn indent(line: &str) -> usize {
    line.len() - line.trim_start().len()
}

/// Where the lines of a paragraph begin after the first: behind the word that is explained, if the
/// line explains one.
fn hang(line: &str) -> usize {
    let at = indent(line);
    let body = &line[at..];
    if is_command(line) {
        return at + 2;
    }
    let explained = body.find("  ").filter(|_| at > 0).map(|end| {
        let gap = body[end..].len() - body[end..].trim_start().len();
        at + end + gap
    });
    match explained {
        Some(column) => column,
        None if body.starts_with('{') => at + 1,
        None => at,
    }
}

/// Whether a line goes on with the paragraph of the one before, which was full.
fn continues(last: &str, next: &str, hang: usize) -> bool {
    const FULL: usize = 84;
    let is_full = last.chars().count() >= FULL;
    is_full && !next.trim().is_empty() && indent(next) == hang && !is_command(last)
}

fn fill(text: &str, hang: usize, is_command: bool, width: usize, out: &mut Vec<String>) {
    let mark = if is_command { " \\" } else { "" };
    let mut line = " ".repeat(indent(text));
    let mut is_empty = true;
    // Blanks between words stay: they make columns.
    for word in text.trim_start().split_inclusive(' ') {
        let more = word.trim_end().chars().count() + mark.len();
        if !is_empty && line.chars().count() + more > width {
            out.push(format!("{}{mark}", line.trim_end()));
            line = " ".repeat(hang);
        }
        line.push_str(word);
        is_empty = false;
    }
    out.push(line.trim_end().to_owned());
}

pub(super) const EXIT_CODES: &str = "\
Exit codes:
  0  answered (contact, separated, free, blocked, overlapping, closer, farther are all answers)
  1  batch, --directions: some lines have no answer; the results say which and why
  2  the command line is wrong
  3  an input file cannot be read, a body is not what it should be, or an output would overwrite an
     input
  4  the query has no certified answer (please report the case); of a motion or a path that is
     undecided the answer says up to which time it is proven free
  5  the output cannot be written
  6  verify: the proof does not hold
  7  path --strict: the answer is about less than the input";

/// Which mesh files are read, and how their numbers are meant.
pub(super) fn formats() -> String {
    format!("Mesh files: {}, told by their extension. {UNITS}", Format::names("and"))
}

const UNITS: &str = "\
Lengths are in the unit of the files; both meshes must have the same one (--moving-scale,
--fixed-scale). Vertex indices in answers count from 0 in the order of the file; the corners of STL
triangles are merged where they are equal, in the order of their first appearance.";

pub(super) const CAST_EXAMPLES: &str = "\
Examples:
  How far can a peg go down from 50 above a plate?
    colltrans cast peg.stl plate.stl --direction -z --moving-pose 0,0,50
  The peg is in inches and lies on its side; the plate has holes, so take its hull:
    colltrans cast peg.stl plate.stl --direction -z --moving-pose 0,0,50 --moving-rpy 90,0,0 \\
      --moving-scale 25.4 --hull-fixed --picture peg.svg
  Many directions, one JSON object a line:
    printf 'x\\n-x\\n1,1,0\\n' | colltrans cast a.obj b.obj --directions - --json";

pub(super) const SETUP_EXAMPLES: &str = "\
Examples:
  For oneself, and for all users of a machine:
    colltrans setup
    sudo colltrans setup --prefix /usr/local
  For a shell that looks elsewhere:
    colltrans setup --print powershell >> $PROFILE";

pub(super) const CLEARANCE_ANSWERS: &str = "\
Answers for convex bodies:
  blocked      the body can go so far, and then touches the other; 0 if it touches now and would
               enter it
  slides       it can go on for ever: the bodies touch along the way, or overlap sideways by no
               more than --graze-tolerance
  behind       it can go on for ever: the bodies only meet behind
  separated    it can go on for ever, and back too: the bodies never meet along this line
  overlapping  the bodies overlap now; the answer says how far to go back, or on, to be free

Answers for parts:
  free         it can go on for ever
  blocked      it can go so far, perhaps 0: `distance` is safe to move by. The faces that stop it meet
               in their true place within `translation_bounds`; the bodies shrunk by half the tolerance
               go as far as `shrunk_distance`
  overlapping  the bodies overlap now, by more than the tolerance; `least_tolerance` is the one
               with which they would not
`exit` is where they meet last: beyond the upper one of `exit_bounds` they never do. Distances are in
multiples of the direction; tolerances and point are in the unit of the meshes. Vertices are
numbered from 0 as in their files; a face is the whole polygon, an edge runs from corner to corner.

With --json one object, in the fields of `batch --help`; of parts, `moving` and `fixed` are the files
that touch, or overlap deepest, and start_overlaps has one entry for each two files that overlap.

Examples:
  How far does a drawer come out, by the hull of both?
    colltrans clearance drawer.stl cabinet.stl --direction -y --hull-moving
  How far does a bolt go down into a plate with a hole, from 7 above it?
    colltrans clearance bolt.stl --from plate.stl --direction -z --moving-pose 0,0,7
  Does the bearing come out of its housing, when curved fits are tessellated to 0.05?
    colltrans clearance ring.stl balls.stl --from housing.stl shaft.stl --direction x --tolerance 0.1
  Parts that are pressed into each other at the start, with a picture:
    colltrans clearance pin.stl --from block.stl --direction z --ignore-start-overlaps \\
      --picture pin.svg
  Which of many bodies does it meet first?
    colltrans clearance hand.stl --among table.stl scene.jsonl --direction -z";

pub(super) const DIRECTIONS_ANSWERS: &str = "\
Answers:
  free         some directions are free: nothing stops the moving body along them, ever
  blocked      none is, which is proven: pairs of faces block cells that cover the sphere
  undecided    none is known to be free, and not all are known: --depth and --looks do more
  overlapping  the bodies overlap now, by more than the tolerance

With --json one object:
  outcome          one of these
  free_share       [at least, at most]: the share of all directions that is free, from 0 to 1
  undecided_share  at most that share is not known
  regions          [{\"share\", \"center\": [x,y,z], \"margin\", \"corners\": [[x,y,z],...], \"pieces\"}]:
                   connected regions, the largest first; margin is the angle from the center to the border, in
                   radians; pieces are convex polygons that together are it; as arcs and points, absent
                   where there are none
  arcs points      directions with no region beside them: [[from, to],...], [[x,y,z],...]
  also_free        free directions among what is undecided, found by casts: [[x,y,z],...]
  blocked_by       [{\"moving\", \"fixed\", \"share\"}] of several files: what was found to block, at least
  tolerance        the one that was used, a length
  cells            how many cells of the sphere the proof has, and undecided_cells of them
  start_overlaps   of bodies that overlap: as of `clearance`

A direction is free where `clearance` along it, with the same tolerance, says so.

Examples:
  Along which directions does a bolt leave its plate?
    colltrans directions bolt.stl plate.stl --tolerance 0.1
  A ring among several parts, with a proof for somebody else:
    colltrans directions ring.stl --from housing.stl shaft.stl --save-proof ring.json
    colltrans verify ring.json";

pub(super) const MOTION_ANSWERS: &str = "\
Answers:
  contact      the bodies first meet at a time between two bounds; point, normal and what touches
  grazing      they come nearer than rounding can tell; not before the time, and nothing is said after it
  free         they never meet throughout the motion; with --keep they never come as near, with --tolerance they
               never overlap by more, or never meet as it leaves them
  overlapping  they overlap when it begins
  blocked      with --clearance, in the place of both contacts: up to the first time it can go

Of several meshes it is the first contact of any two, and says of which.

With --json one object:
  outcome   one of these
  time      {\"lower\", \"upper\"}: not before the first, and at the second they do; 0 is the start of the
            motion, 1 its end
  point normal features   as of `cast`, at that time
  moving fixed   of several meshes: which
  keep tolerance   as they were asked for; with --clearance the tolerance that was used
  shrunk_time start_overlaps   with --clearance: when they meet as the tolerance leaves them; what overlaps
  looks planes   how often the bodies were looked at, and planes in the proof, which only convex meshes have unasked

Examples:
  Does a door that swings by 90 degrees about the z axis hit a post?
    colltrans motion door.stl post.stl --turn 0,0,0 z 90
  Which of three machines does a crane hit first, while a cart comes the other way?
    colltrans motion hook.stl --from lathe.stl press.stl saw.stl --turn 0,0,0 z 180
    colltrans motion hook.stl cart.stl --turn 0,0,0 z 180 --fixed-slide -2,0,0
  How far can a box that stands on a table be tipped, or turned there?
    colltrans motion box.stl table.stl --turn 0,0,0 y 30 --clearance
  A bolt is unscrewed by two turns, 3 up:
    colltrans motion bolt.stl plate.stl --screw 0,0,0 z 720 3 --save-proof bolt.json
    colltrans verify bolt.json";

pub(super) const PATH_ANSWERS: &str = "\
Rows of a path:
  CSV       a row a line; a first line of names says which joint each column is of, one may be `time`;
            without names there is a value for each joint that moves by itself, in the order of the
            robot's file. What follows a # counts for nothing
  JSON      a list of rows, or what ROS has: {\"joint_names\": [...], \"points\": [{\"positions\": [...],
            \"time_from_start\": ...}]}, or that as \"joint_trajectory\" of an object. Velocities and
            accelerations are not used, and the answer says so
  Joints that follow others (mimic) have no values of their own. One row is a place, not a path.

Answers:
  contact      two bodies first meet at a time between two bounds, and no others before: who, where on
               the path, the point and the normal
  grazing      two come nearer than rounding can tell; none meet before, and nothing is said after it
  free         none meet on the whole path
  overlapping  some overlap where it begins: all of them are named, as --ignore and SRDF take them
  undecided    the search between two took its maximum number of steps; none meet before (exit code 4)

With --json one object:
  outcome   one of these
  time      {\"lower\", \"upper\"}: none meet before the first, and at the second two do; in the times of
            the path, or in rows from 0 if it has none
  place     {\"row\", \"share\"}: which share of the way from that row to the next one is done at lower
  pair      the names of the two: links, or meshes of the scene
  point normal   where the first is nearest to the second then, and the direction to it, in the world
  overlaps  where it begins: the names of all pairs that overlap there, or are as near as keep
  hulls     links whose meshes their convex hulls stand for: a contact of one is that of its hull
  dents     {NAME: DEPTH} of meshes that are convex only to within the tolerance: how deep the surface
            lies below its hull, which stands for it
  notes     in what the answer is about less than the input
  pairs looks planes   how many pairs of bodies were asked about, how often two were looked at, and planes
            in the proof

Examples:
  Is this path free, of the links and of two meshes that stand around?
    colltrans path arm.urdf path.csv table.stl wall.stl --srdf arm.srdf
  With a gap of 5 mm kept, fingers that rest, and a proof for somebody else:
    colltrans path arm.urdf path.csv --joint finger=0.02 --keep 0.005 --save-proof path.json
    colltrans verify path.json";

pub(super) const DISTANCE_ANSWERS: &str = "\
Answers of distance:
  apart        so far, between two bounds that are proven, with the points that are nearest, the
               normal from the moving to the fixed body and what of each body faces the other
  meeting      they touch or overlap, with a point of both: proven where the upper bound is 0, else
               they are at most that far apart, which is rounding

Answers of depth:
  overlapping  of convex bodies, the shortest translation of the moving body that parts them, between
               two bounds that are proven; of parts the least tolerance with which they would not
               overlap
  touching     they touch, or may overlap by less than rounding can tell
  apart        0: they have no point in common

Answers of within:
  closer       a point of each is at most the length apart
  farther      no two points are as near as the length
  undecided    the length lies between the bounds of the distance, a few roundings apart

All lengths are in the unit of the meshes. With --json one object, in the fields of `batch --help`; of
parts, `moving` and `fixed` are the files that are nearest, or overlap deepest.

Examples:
  How near is a gripper to a table, and where?
    colltrans distance gripper.stl table.stl --moving-pose 0,0,50
  Parts with holes, several files a body, with a picture and a proof:
    colltrans distance bolt.stl nut.stl --from plate.stl frame.stl --picture near.svg \\
      --save-proof near.json
  Which way out, by the hull of both?
    colltrans depth peg.stl plate.stl --hull
  Does a part keep 0.5 from its housing?
    colltrans within shaft.stl --from housing.stl --length 0.5
  Which of many bodies is nearest, and which are closer than 0.1?
    colltrans distance hand.stl --among table.stl scene.jsonl
    colltrans within hand.stl --among scene.jsonl --length 0.1";

pub(super) const BATCH_FORMAT: &str = r#"Each line of the queries is one JSON object:
  {"id": any, "moving": BODY, "fixed": BODY, "moving_pose": POSE, "fixed_pose": POSE,
   "direction": [x,y,z], "query": "contact"|"clearance"|"distance"|"depth"|
   "within"|"motion", "length": L (of "within"),
   "moving_motion": MOTION, "fixed_motion": MOTION (of "motion"),
   "graze_tolerance": L, "solver": "auto"|"cta"|"portal" (of convex bodies),
   "start": "center"|"ellipsoids", "until": "exit"|SHARE (of "cta"),
   "tolerance": L (of solids and motions), "ignore_start_overlaps": true|false (of solids),
   "keep": GAP}
  BODY = {"points": [[x,y,z],...]} (their convex hull)
       or {"mesh": "path", "hull": true|false, "scale": FACTOR}
       or {"solid": "path", "scale": FACTOR, "open": BOOL} (need not be convex; open: nor closed)
  (hull and scale may be missing: as --hull says, and 1)
  query is "contact", as of `colltrans cast`, or "clearance", as of `colltrans clearance`. Solids are
  not asked for "contact"; "clearance" is the default there. "distance", "depth" and "within" are those
  of the commands, of bodies of any kind where they are.
  "motion" is `colltrans motion`, of bodies of any kind, of which one or both move.
  POSE = {"translation": [x,y,z], "rotation": [qx,qy,qz,qw]}, either may be missing. A quaternion of few
         digits is normalised, as of --moving-pose; the notes of the result name it
  MOTION = {"slide": {"by": [x,y,z]}}
       or {"turn": {"point": [x,y,z], "axis": [x,y,z], "radians": ANGLE}}
       or {"screw": {"point": [x,y,z], "axis": [x,y,z], "radians": ANGLE, "rise": L}}
       or {"thrown": {"center": [x,y,z], "velocity": [x,y,z], "angular_velocity": [x,y,z]}}
       or {"between": {"from": POSE, "to": POSE}} or {"through": {"poses": [POSE,...]}}
       or {"still": {}}, from the pose of the body on, unless it has its own
moving and fixed are required, the direction of "contact" and "clearance", and a MOTION of "motion". Paths are relative to the folder of the query file, or to
the current folder for standard input. Blank lines are skipped, unknown fields are errors.

Each result is one JSON object with those of these fields that apply:
  id           as in the query (null if it cannot be read)
  outcome      "contact", "grazing", "separated" or "error"; of a clearance: "blocked", "slides",
               "behind", "separated" or "overlapping"; of solids: "free", "blocked" or "overlapping";
               of a distance: "apart" or "meeting"; of a depth: "overlapping", "touching"
               or "apart"; within: "closer", "farther" or "undecided"; of a motion: "contact",
               "grazing", "free" or "overlapping"
  time         of a motion: {"lower", "upper"}, from 0 at its start to 1 at its end; proven
  direction    with --directions: the direction as it was read; of a depth: the unit vector along
               which the moving body leaves by the shortest way
  lower upper  of a distance or a depth: at least and at most that, proven; of "closer" the upper one
               alone, of "farther" the lower one
  points       [moving, fixed]: points of both, in the world, that are so near
  distance     of a clearance, blocked: how far it is safe to move, the lower one of
               translation_bounds, and never negative
  back on      of a clearance, overlapping: how far to go back, or on, to be free for certain
  translation  first contact, in multiples of the direction; negative: behind, or overlapping; of
               solids: where the faces that stop them meet in their true place
  exit         last contact; behind: where that is (and normal, point, features are those there)
  shrunk_distance  of solids, blocked: how far they go, shrunk by half the tolerance each
  translation_bounds exit_bounds shrunk_distance_bounds
               [at least, at most] of the number before them, proven: [lower, upper]; null where
               nothing is known, as of bodies that slide so lightly that they may not touch. Of
               solids the upper bound of translation holds of the parts as they are, or else, where
               the two faces pass each other as they are, of the shrunk ones
  rounding     of convex bodies: what rounding alone can make of the bounds' difference
  tolerance    of solids: the one that was used, both are shrunk by half of it
  keep         the gap that is kept: the bodies count as meeting where they are as near
  start_overlaps  of solids that overlap now: [{"least_tolerance"}], the one with which they
               would not; missing of surfaces
  surfaces     of solids: which bodies are open, at least in part: ["moving", "fixed"]
  normal       unit normal from moving to fixed: of the contact plane, of the separating plane, or
               along the shortest way
  point        the contact point on the fixed body, in the world
  features     {"moving": {"kind": "vertex"|"edge"|"face", "vertices": [...]}, "fixed": ...} by the
               indices of the points or mesh vertices in the input
  margin       separated: gap between the shadows (the projections along the direction), measured
               along normal, a lower bound of their distance
  overlap      grazing, slides: by how much the shadows overlap; negative where they may not
  sideways     grazing, slides: the unit vector across the direction along which they do
  hull         {"moving": EXCESS, "fixed": EXCESS} where the hull of a mesh was taken that is not
               convex. EXCESS = {"hull_volume", "part_volume" (of a closed mesh), "depth"}: the
               largest depth of the mesh's surface below the hull's. Then "separated" holds for the
               parts too, and a translation is a lower bound: they meet no earlier, if at all.
  dents        {"moving": DEPTH, "fixed": DEPTH} where a mesh is convex only to within the tolerance: how
               deep its surface lies below its hull, which stands for it
  solver steps of convex bodies: what narrowed the search for a contact, how much work it was
  message      what is wrong; grazing: along which direction the shadows overlap
  notes        what was merged or mended when the meshes were read; quaternions that were normalised

Translations, the distance of a clearance, their bounds and rounding are in multiples of the
direction, other lengths in the unit of the meshes. Bodies that occur again are built once while they fit (--cache-bytes). A file of results
that exists is replaced when all lines are answered, and never if a query reads it. A line may have
up to 64 MiB."#;

pub(super) const ASSEMBLY_FORMAT: &str = r#"SOURCE is a folder of meshes, each a part in its place; a manifest (.toml, .json);
a URDF file (metres); .glb, .gltf (metres) or .3mf (the unit it says).

A manifest, in TOML (JSON has the same fields):
  unit = "mm"                                # said, never guessed; may be missing
  ignore = [["pin", "block"]]                # pairs whose overlap at the start lets them pass
  ignore_always = [["rubber", "lid"]]        # pairs that never block each other
  pair = [{ parts = ["bush", "body"], role = "press", tolerance = 0.08 }]
                                             # or thread, soft, snap, glued
  before = [["pin", "lid"]]                  # the second does not leave while the first stays
  after = [["block", "pin"]]                 # the other way round
  together = [["rotor", "magnet_*"]]         # leave as one, and are not taken apart
  subassembly = [{ name = "pump", parts = ["rotor", "ring"] }]
                                             # leave as one, then apart
  never = [{ parts = ["tank"], along = [0, 0, -1], within_degrees = 45 }]
  [[part]]
  file = "pin.stl"                           # or several: ["a.stl", "b.stl"]
  name = "pin"                               # the file's name, if missing
  translation = [0, 0, 5]
  rotation = { rpy_degrees = [0, 90, 0] }    # or quaternion = [x, y, z, w], or matrix = rows
  scale = 0.9
  fixed = true                               # never moved
  split = "bodies"                           # or "names", "never": as --split

With --json:
  {"parts": [{"name", "facets", "volume", "volume_bounds"}], "unit", "tolerance" (or "keep_apart"),
   "overlaps": [{"parts": [a, b], "least_tolerance", "remains"}], "suggested_tolerance",
   "suggestions": [{"parts", "role", "tolerance", "why"}], "pairs": [{"parts", "role", "words"}],
   "liaisons": [{"parts": [a, b], "area", "area_bounds", "center"}],
   "rooms": [{"part", "direction", "outcome", "distance", "by", "point", "normal",
     "translation", "translation_bounds", "shrunk_distance", "shrunk_distance_bounds" (or "kept_distance", "kept_distance_bounds")}],
   "plan": [{"parts": [...], "direction": [x, y, z], "travel", "travel_bounds",
     "path": [{"parts", "direction", "travel", "turn": {"point", "axis", "turns", "pitch",
       "phase", "aside", "words", "proof": {"tolerance", "pairs"} or "not_proven"}}], "back", "within", "ignored", "passed",
     "surfaces", "subassembly"}], "wanted" (of --remove): {"parts", "others", "least", "out"},
   "rounds": [[step, ...]], "assembly": [{"step", "after"}], "seconds": [...],
   "left": [...], "stuck": [{"parts": [...], "because", "directions", "proof": {"proven": cells} or
     {"asked": directions}, "moves": {"legs", "directions", "places", "complete"} or
     {"proven": cells} or {"not_asked": why}, "holds"}],
   "maps": [...], "free": [...] (of --free: as of `directions --help`, with "parts")}
  Directions have length 1, so distances are lengths; distance is safe to move by, proven: what stops
  the part has not met in its true place (translation), and the parts, shrunk by half the tolerance
  each or grown by half the length to keep, do not overlap, which they do from grown_ or
  shrunk_distance on. The two of _bounds enclose the number, proven. outcome is "free", "blocked" or
  "overlapping". A step with "within" takes apart the group that step (from 0) took out. "path" is
  its moves, in order: with the last one its parts leave. What made room before goes "back".

With -o DIR: report.html, disassembly.glb, assembly.json, matrix.csv (who meets whom), precedence.csv
(the steps, and which wait for which), precedence.json (of each part its ways out: all parts of one
have to go), and for each map a .svg, .png and .json, for each part of --free the proof."#;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_text_fits_every_terminal() {
        let texts = [
            EXIT_CODES,
            &formats(),
            CAST_EXAMPLES,
            CLEARANCE_ANSWERS,
            DIRECTIONS_ANSWERS,
            DISTANCE_ANSWERS,
            MOTION_ANSWERS,
            PATH_ANSWERS,
            BATCH_FORMAT,
            ASSEMBLY_FORMAT,
        ];
        let words = |text: &str| {
            let all = text.split_whitespace().filter(|word| *word != "\\");
            all.map(str::to_owned).collect::<Vec<_>>()
        };
        for text in texts {
            for width in [60, 80, 100] {
                let filled = filled(text, width);
                let longest = filled.lines().max_by_key(|line| line.chars().count()).unwrap();
                assert!(longest.chars().count() <= width, "{longest}");
                assert_eq!(words(&filled), words(text));
            }
        }
        let explained = "  back on   how far to go back, or on,\n            to be free";
        assert_eq!(filled(explained, 80), explained);
        let command = filled("    colltrans cast peg.stl plate.stl --direction -z", 40);
        assert_eq!(command, "    colltrans cast peg.stl plate.stl \\\n      --direction -z");
    }
}

//! The texts of `--help` below the table of options, and the topics `files` and `json`, wrapped to the terminal.

use colltrans_mesh::Format;

/// Maximum length of a line in characters.
pub(super) const MAX_WIDTH: usize = 100;

/// Returns the width of the terminal in columns, as clap determines it, at most [`MAX_WIDTH`].
fn terminal_width() -> usize {
    let terminal = terminal_size::terminal_size().map(|(width, _)| usize::from(width.0));
    let columns = || std::env::var("COLUMNS").ok()?.parse().ok();
    terminal.or_else(columns).filter(|c| *c > 0).unwrap_or(MAX_WIDTH).min(MAX_WIDTH)
}

/// Joins texts with blank lines, wrapped to the width of the terminal.
pub(super) fn fit_to_terminal(texts: &[&str]) -> String {
    let width = terminal_width();
    texts.iter().map(|text| wrap_paragraphs(text, width)).collect::<Vec<_>>().join("\n\n")
}

/// Wraps the paragraphs of a text that have lines longer than `width`. Other paragraphs stay unchanged.
fn wrap_paragraphs(text: &str, width: usize) -> String {
    let mut out: Vec<String> = Vec::new();
    let mut lines = text.lines().peekable();
    while let Some(first) = lines.next() {
        let hanging_indent = hanging_indent(first);
        let mut words = vec![first.to_owned()];
        let mut last = first;
        while let Some(next) = lines.next_if(|next| continues_paragraph(last, next, hanging_indent))
        {
            words.push(next.trim_start().to_owned());
            last = next;
        }
        let fits = |line: &String| line.chars().count() <= width;
        if words.len() == 1 && fits(&words[0]) {
            out.push(first.to_owned());
        } else {
            wrap_paragraph(&words.join(" "), hanging_indent, is_command(first), width, &mut out);
        }
    }
    out.join("\n")
}

/// Checks whether a line shows a command, which needs a backslash where it is broken.
fn is_command(line: &str) -> bool {
    line.starts_with("    ") && line.contains("colltrans ")
}

/// Returns the number of leading blanks.
fn indent(line: &str) -> usize {
    line.len() - line.trim_start().len()
}

/// Returns the indent of the second and later lines of a paragraph. If the first line is indented and has at least two
/// blanks between a word and its explanation, this is the column of the explanation. Otherwise it is the indent of the
/// first line, with one more column after `{`. For a command it is always the indent of the first line and two more.
fn hanging_indent(line: &str) -> usize {
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

/// Checks whether a line continues the paragraph of the previous line, which then has at least 84 characters.
fn continues_paragraph(last: &str, next: &str, hanging_indent: usize) -> bool {
    const MIN_FULL_LINE: usize = 84;
    let is_full = last.chars().count() >= MIN_FULL_LINE;
    is_full && !next.trim().is_empty() && indent(next) == hanging_indent && !is_command(last)
}

/// Appends the lines of one paragraph.
fn wrap_paragraph(
    text: &str,
    hanging_indent: usize,
    is_command: bool,
    width: usize,
    out: &mut Vec<String>,
) {
    let mark = if is_command { " \\" } else { "" };
    let mut line = " ".repeat(indent(text));
    let mut is_empty = true;
    // Repeated blanks between words are kept because they align columns.
    for word in text.trim_start().split_inclusive(' ') {
        let more = word.trim_end().chars().count() + mark.len();
        if !is_empty && line.chars().count() + more > width {
            out.push(format!("{}{mark}", line.trim_end()));
            line = " ".repeat(hanging_indent);
        }
        line.push_str(word);
        is_empty = false;
    }
    out.push(line.trim_end().to_owned());
}

/// The last line of every `-h`.
pub(super) const SEE_ALL: &str = "\
`--help` shows all options and examples, `colltrans help files` the formats, units and exit codes.";

/// Begins the topic of file formats; the names of the mesh formats follow from the code.
fn mesh_files() -> String {
    let formats = Format::list_names("and");
    format!("Mesh files: {formats}, recognised by the extension. {VERTICES}\n\n{SHAPES}")
}

/// Returns the topic `colltrans help files`.
pub(crate) fn files_topic() -> String {
    fit_to_terminal(&[&mesh_files(), UNITS_AND_POSES, NUMBERS, BODIES, LISTS, MANIFEST, EXIT_CODES])
}

/// Returns the topic `colltrans help json`.
pub(crate) fn json_topic() -> String {
    fit_to_terminal(&[JSON_FIELDS, JSON_ASSEMBLY])
}

const VERTICES: &str = "\
Vertex indices in answers count from 0
in the order of the file. Equal corners of STL triangles are merged, in the order of their first
appearance. Features are named by them: a face is the whole polygon, an edge joins two corners.";

const SHAPES: &str = "\
Shapes instead of files: sphere:R, capsule:AX,AY,AZ,BX,BY,BZ,R (the ends of its axis), box:X,Y,Z,
and box:X,Y,Z,R (rounded by R). They are exact. Spheres and boxes are centred. Features name the
vertices, edges and faces of the point, the segment or the box. `info` and `path` do not accept
shapes, and `free` no round ones.";

const UNITS_AND_POSES: &str = "\
Units: lengths are in the unit of the files, which must be the same for both meshes (--moving-scale
and --fixed-scale convert it). Translations and distances along a direction are multiples of the
direction. They are lengths if it has length 1, as the axes x, -x, y, -y, z, -z have.

Poses: x,y,z or x,y,z,qx,qy,qz,qw. The mesh is rotated by the unit quaternion, then translated. A
quaternion with few digits is normalised, with a note. A quarter turn about z, then one unit up:
0,0,1,0,0,0.7071067811865476,0.7071067811865476. --moving-rpy takes angles in degrees instead: about
the world's x axis, then y, then z (as in URDF), through the origin of the mesh, before the
translation. Multiples of 90 are exact.";

const NUMBERS: &str = "\
Numbers: text has the digits that are known, at most nine; JSON, tables and proofs have all digits.
An interval is its middle ± half its width, or its two ends if the half width is more than a
hundredth of the middle. It contains the proven interval. Lower bounds, distances that are safe to
move by and minimum gaps are rounded down. Upper bounds are rounded up, and so are tolerances, to
six digits. Points are rounded at 1e-7 of the extent of the smaller body, the components of unit
vectors at 1e-7.";

const BODIES: &str = "\
Bodies:
  convex   a mesh without dents deeper than --convex-tolerance. The body is its hull. Rounded
           coordinates (STL: single precision, about 6e-8 of the largest one) cause such dents
  hull     --hull replaces a mesh by the hull of the vertices in use. `separated` then holds for the
           part too; a contact of hulls is a lower bound: the part meets no earlier
  part     a closed surface that need not be convex, with its holes and cavities. Several files on one
           side are one body. Each body is offset inwards by half of --tolerance. A curved fit needs
           the sum of both chord errors. The default is twice the rounding of both files (2.4e-7 of
           the largest coordinate for binary STL and float PLY, else 3.6e-15), and at least the
           rounding of rotated poses
  open     --open accepts surfaces that are not closed, for example sheets and scans
  merging  --merge-tolerance merges near vertices on open edges, by default within the rounding of
           the file: 2.4e-7 or 3.6e-15 of the largest coordinate. 0 merges equal vertices only";

const LISTS: &str = "\
Directions: a file with one per line, three numbers or an axis. Blank lines and text after # are
ignored. A direction without an answer does not end the command (exit code 1).

Scenes: meshes in place, and files of obstacles (.jsonl) with one object per line: {\"body\": BODY,
\"pose\": POSE, \"name\": \"...\"}, see `colltrans batch --help`. A repeated body is stored once.";

const MANIFEST: &str = r#"Manifest of an assembly, in TOML (JSON has the same fields):
  unit = "mm"                                # optional; a unit is never guessed
  densities = { steel = 7850 }               # of materials, in kg/m3; optional
  ignore = [["pin", "block"]]                # pairs whose overlap at the start is ignored
  ignore_always = [["rubber", "lid"]]        # pairs that never block each other
  pair = [{ parts = ["bush", "body"], role = "press", tolerance = 0.08 }]
                                             # or thread, soft, snap, glued
  before = [["pin", "lid"]]                  # the second does not leave while the first is present
  after = [["block", "pin"]]                 # the first does not leave while the second is present
  together = [["rotor", "magnet_*"]]         # leave together and stay together
  subassembly = [{ name = "pump", parts = ["rotor", "ring"] }]
                                             # leave together, then are taken apart
  never = [{ parts = ["tank"], along = [0, 0, -1], within_degrees = 45 }]
  [[part]]
  file = "pin.stl"                           # or several: ["a.stl", "b.stl"]
  name = "pin"                               # default: the name of the file
  translation = [0, 0, 5]
  rotation = { rpy_degrees = [0, 90, 0] }    # or quaternion = [x, y, z, w], or matrix = rows
  scale = 0.9
  fixed = true                               # never moves
  material = "steel"                         # optional, for the bill of materials
  density = 7850                             # optional, in kg/m3
  split = "bodies"                           # or "names", "never": as --split"#;

const EXIT_CODES: &str = "\
Exit codes:
  0  answered (contact, separated, free, blocked, overlapping, closer, farther are all answers)
  1  batch, --directions: some lines have no answer; the results state which and why; audit: a pair
     interferes or is nearer than its clearance
  2  the command line is wrong
  3  an input file cannot be read, a body is not acceptable, or an output would overwrite an input
  4  no certified answer (please report the case); an undecided motion or path states how long it is
     proven free
  5  the output cannot be written
  6  verify: the proof does not hold
  7  path --strict: the answer covers less than the input";

pub(super) const INFO_NOTES: &str = "\
Examples:
    colltrans info bracket.stl plate.obj

`colltrans help files`: mesh formats, units, tolerances, exit codes.";

pub(super) const CAST_NOTES: &str = "\
Answers:
  contact    the bodies first touch at `translation`, and last at `exit`
  grazing    the bodies slide along each other: they overlap sideways by no more than
             --graze-tolerance
  separated  the bodies never touch along this line

Examples:
  How far can a peg go down from 50 above a plate?
    colltrans cast peg.stl plate.stl --direction -z --moving-pose 0,0,50
  The peg is in inches and lies on its side; the plate has holes, so take its hull:
    colltrans cast peg.stl plate.stl --direction -z --moving-pose 0,0,50 --moving-rpy 90,0,0 \\
      --moving-scale 25.4 --hull-fixed --picture peg.svg
  Many directions, one JSON object per line:
    printf 'x\\n-x\\n1,1,0\\n' | colltrans cast a.obj b.obj --directions - --json

`colltrans help files`: formats, units, poses, bodies, exit codes; `colltrans help json`: fields.";

pub(super) const SETUP_NOTES: &str = "\
Examples:
  For one user, and for all users of a machine:
    colltrans setup
    sudo colltrans setup --prefix /usr/local
  For a shell that searches elsewhere:
    colltrans setup --print powershell >> $PROFILE

`colltrans help files`: exit codes.";

pub(super) const REPLAY_NOTES: &str = "\
Examples:
    colltrans replay colltrans-case-1.json --json

`colltrans help files`: exit codes; `colltrans help json`: fields of the answer.";

pub(super) const VERIFY_NOTES: &str = "\
Examples:
    colltrans clearance bolt.stl plate.stl --direction z --save-proof bolt.json
    colltrans verify bolt.json
    colltrans verify proofs/*.json

`colltrans help files`: exit codes; `colltrans help json`: fields of the answer.";

pub(super) const CLEARANCE_NOTES: &str = "\
Answers for convex bodies:
  blocked      the body can move by `distance`, then it touches; 0 if it touches now and would enter
  slides       free: the bodies touch along the way, or overlap by no more than --graze-tolerance
  behind       free: the bodies only meet behind
  separated    free, also backwards: the bodies never meet along this line
  overlapping  the bodies overlap now; `back` and `on` are the travels after which they are free
Answers for parts:
  free         nothing blocks the body
  blocked      `distance` is safe to move by, perhaps 0. The faces that stop the nominal bodies meet
               within `translation_bounds`, the offset bodies at `offset_distance`
  overlapping  the bodies overlap now by more than the tolerance; `least_tolerance` would suffice
`exit` is where the bodies meet last. Beyond the upper one of `exit_bounds` they never meet.

Examples:
  How far does a drawer come out, by the hull of both?
    colltrans clearance drawer.stl cabinet.stl --direction -y --hull-moving
  How far does a bolt go down into a plate with a hole, from 7 above it?
    colltrans clearance bolt.stl --from plate.stl --direction -z --moving-pose 0,0,7
  Does the bearing come out, when curved fits are tessellated to 0.05?
    colltrans clearance ring.stl --from housing.stl shaft.stl --direction x --tolerance 0.1
  Parts that are pressed into each other at the start, with a picture:
    colltrans clearance pin.stl block.stl --direction z --ignore-start-overlaps --picture pin.svg
  Which body of a scene does it meet first?
    colltrans clearance hand.stl --scene table.stl scene.jsonl --direction -z

`colltrans help files`: formats, units, poses, bodies, exit codes; `colltrans help json`: fields.";

pub(super) const DIRECTIONS_NOTES: &str = "\
Answers:
  free         some directions are free: nothing ever stops the moving body along them
  blocked      none is free, proven: pairs of faces block cells that cover the sphere
  undecided    no direction is known to be free; larger --depth and --looks decide more
  overlapping  the bodies overlap now by more than the tolerance

With --json one object:
  outcome          one of these
  free_share       [lower, upper] bounds of the share of all directions that is free, from 0 to 1
  undecided_share  an upper bound of the share that is undecided
  regions          connected regions, the largest first: [{\"share\", \"center\": [x,y,z], \"margin\",
                   \"corners\": [[x,y,z],...], \"pieces\"}]. margin is the angle from the center to the
                   border, in radians; pieces are convex polygons that together form the region
  arcs points      free directions without a region around them: [[from, to],...], [[x,y,z],...]
  also_free        free directions in undecided cells, found by casts: [[x,y,z],...]
  blocked_by       [{\"moving\", \"fixed\", \"share\"}] of several files: the share of the blocked
                   cells that are attributed to them, not a bound of what they block
  tolerance        the tolerance used, a length
  cells undecided_cells   number of cells of the sphere in the proof, and of undecided ones
  start_overlaps   of bodies that overlap: as for `clearance`

Examples:
  Along which directions does a bolt leave its plate?
    colltrans directions bolt.stl plate.stl --tolerance 0.1
  A ring among several parts, with a proof:
    colltrans directions ring.stl --from housing.stl shaft.stl --save-proof ring.json
    colltrans verify ring.json

`colltrans help files`: mesh formats, units, poses, tolerances, exit codes.";

pub(super) const MOTION_NOTES: &str = "\
Answers:
  contact      the bodies first touch at a time between two bounds
  grazing      they come nearer than rounding resolves; nothing is stated about later times
  free         they never touch; with --min-gap never come as near, with --tolerance never overlap by more
  overlapping  they overlap when the motion begins
  blocked      with --clearance, instead of contact and grazing: free until the first time
Of several meshes it is the first contact of any pair.

With --json one object, with the fields of `colltrans help json` and these:
  time            {\"lower\", \"upper\"}: no contact before the first, a contact at the second
  shrunk_time     with --clearance: the same for the bodies offset by the tolerance
  looks planes    number of distance samples, and of planes in the proof

Examples:
  Does a door that swings by 90 degrees about the z axis hit a post?
    colltrans motion door.stl post.stl --turn 0,0,0 z 90
  A crane turns while a cart comes the other way:
    colltrans motion hook.stl cart.stl --turn 0,0,0 z 180 --fixed-slide -2,0,0
  How far can a box on a table be tipped, or turned there?
    colltrans motion box.stl table.stl --turn 0,0,0 y 30 --clearance
  A bolt is unscrewed by two turns, 3 up:
    colltrans motion bolt.stl plate.stl --screw 0,0,0 z 720 3 --save-proof bolt.json

`colltrans help files`: mesh formats, units, poses, tolerances, exit codes.";

pub(super) const PATH_NOTES: &str = "\
Rows of a path:
  CSV   one row per line. A first line of names selects the joint of each column; one may be `time`.
        Without names there is a value for each independent joint, in the order of the robot's file.
        Text after # is ignored
  JSON  a list of rows, or a ROS trajectory: {\"joint_names\": [...], \"points\": [{\"positions\": [...],
        \"time_from_start\": ...}]}, or that as \"joint_trajectory\" of an object. Velocities and
        accelerations are not used, and the answer states so
  Joints that follow others (mimic) have no values. Between rows each joint moves uniformly. One row
  is not a path.

Answers:
  contact      two bodies first touch at a time between two bounds, and no others before
  grazing      two come nearer than rounding resolves; no contact before, no statement after
  free         no contact on the whole path
  overlapping  some overlap where the path begins: all pairs, in the form of --ignore and SRDF
  undecided    the search between two took its maximum number of steps (exit code 4)

With --json one object:
  outcome   one of these
  time      {\"lower\", \"upper\"}: no contact before the first, a contact at the second; in the times of
            the path, or in rows from 0 if it has none
  place     {\"row\", \"share\"}: the share of the way from that row to the next one, at lower
  pair      the names of the two bodies: links, or meshes of the scene
  point normal   where the first is nearest to the second then, and the direction to it, in the world
  overlaps  the names of all pairs that overlap at the start, or are within the minimum gap
  hulls     links that are replaced by their hulls: a contact is that of the hull
  dents     {NAME: DEPTH} of meshes that are convex only to within the tolerance
  notes     how the answer covers less than the input
  pairs looks planes   number of pairs of bodies, of distance samples, and of planes in the proof

Examples:
  Is this path free for the links and two meshes of the scene?
    colltrans path arm.urdf path.csv table.stl wall.stl --srdf arm.srdf
  With a minimum gap of 5 mm, fixed fingers and a proof:
    colltrans path arm.urdf path.csv --joint finger=0.02 --min-gap 0.005 --save-proof path.json
    colltrans verify path.json

`colltrans help files`: mesh formats and exit codes.";

pub(super) const DISTANCE_NOTES: &str = "\
Answers:
  apart    the distance, with the nearest points, the normal from the moving to the fixed body, and
           the features that face each other
  meeting  the bodies touch or overlap, with a common point: proven if the upper bound is 0,
           otherwise they are at most that far apart, which is rounding

Examples:
  How near is a gripper to a table, and where?
    colltrans distance gripper.stl table.stl --moving-pose 0,0,50
  Parts with holes, several files per body, with a picture and a proof:
    colltrans distance bolt.stl nut.stl --from plate.stl frame.stl --picture near.svg \\
      --save-proof near.json
  Which body of a scene is nearest?
    colltrans distance hand.stl --scene table.stl scene.jsonl

`colltrans help files`: formats, units, poses, scenes, exit codes; `colltrans help json`: fields.";

pub(super) const DEPTH_NOTES: &str = "\
Answers:
  overlapping  bounds of the shortest translation of the moving body that separates them, and the one
               that was found; of parts also the least tolerance with which they would not overlap
  touching     the bodies touch, or overlap by less than rounding resolves
  apart        0: the bodies have no common point

Examples:
  Which way out, by the hull of both?
    colltrans depth peg.stl plate.stl --hull
  Prove how much of two parts overlaps:
    colltrans depth peg.stl plate.stl --common-part --save-proof proof.json

`colltrans help files`: mesh formats, units, poses, exit codes; `colltrans help json`: fields.";

pub(super) const WITHIN_NOTES: &str = "\
Answers:
  closer     a point of each body is at most the length apart
  farther    no two points are as near as the length
  undecided  the length lies between the bounds of the distance, a few roundings apart

Examples:
  Does a part keep a gap of 0.5 to its housing?
    colltrans within shaft.stl --from housing.stl --length 0.5
  Which bodies of a scene are closer than 0.1?
    colltrans within hand.stl --scene scene.jsonl --length 0.1

`colltrans help files`: formats, units, poses, scenes, exit codes; `colltrans help json`: fields.";

pub(super) const BATCH_FORMAT: &str = r#"Each line of the queries is one JSON object:
  {"id": any, "moving": BODY, "fixed": BODY, "moving_pose": POSE,
   "fixed_pose": POSE, "direction": [x,y,z],
   "query": "contact"|"clearance"|"distance"|"depth"|
            "within"|"motion"|"motion_clearance",
   "length": L (of "within"), "min_gap": GAP (the minimum gap),
   "moving_motion": MOTION, "fixed_motion": MOTION (of motions),
   "graze_tolerance": L, "solver": "auto"|"cta"|"portal" (of convex bodies),
   "start": "center"|"ellipsoids"|"guess", "until": "exit"|SHARE,
   "cuts": "shifted"|"centroid", "across_cells": true|false,
   "cold": true|false (all five of "cta"),
   "tolerance": L (of solids and motions),
   "ignore_start_overlaps": true|false (of solids)}
  BODY = {"points": [[x,y,z],...], "radius": R} (their convex hull, rounded by R)
       or {"sphere": R}, or {"capsule": [[x,y,z],[x,y,z]], "radius": R}
       or {"mesh": "path", "hull": true|false, "scale": FACTOR, "radius": R} (convex)
       or {"solid": "path", "scale": FACTOR, "open": true|false, "radius": R} (any shape)
  (defaults of hull and scale: as --hull, and 1)
  POSE = {"translation": [x,y,z], "rotation": [qx,qy,qz,qw]}, each optional. A quaternion with few
         digits is normalised, with a note in the result
  MOTION = {"slide": {"by": [x,y,z]}}
       or {"turn": {"point": [x,y,z], "axis": [x,y,z], "radians": ANGLE}}
       or {"screw": {"point", "axis", "radians": as a turn, "rise": L}}
       or {"thrown": {"center", "velocity", "angular_velocity": [x,y,z] each}}
       or {"between": {"from": POSE, "to": POSE}}
       or {"through": {"poses": [POSE,...]}}
       or {"still": {}}
         (from the pose of the body, unless it has poses; "degrees" replaces "radians")
moving and fixed are required; so are the direction of "contact" and "clearance", and one MOTION of
"motion". The default query is "contact", or "clearance" if a body is a solid; solids have no "contact". Paths are relative to the folder of
the query file, or to the current folder for standard input. Blank lines are skipped, unknown fields
are errors. A line has at most 64 MiB.

Each result is one JSON object, see `colltrans help json`. Bodies that occur again are built once
while they fit in memory. A file of results that exists is replaced when all lines are answered, and never if
a query reads it.

Examples:
    colltrans batch queries.jsonl -o results.jsonl
    colltrans batch - --threads 1 < queries.jsonl
    colltrans batch queries.jsonl --fields translation,translation_bounds

`colltrans help files`: mesh formats, units, tolerances, exit codes."#;

const JSON_FIELDS: &str = r#"Answers of cast, clearance, distance, depth, within, motion and batch: one JSON object with those of
these fields that apply. Numbers have all digits. Translations, the distance of a clearance, their
bounds and rounding are multiples of the direction; other lengths are in the unit of the meshes.
  id           of a batch: as in the query (null if it cannot be read)
  outcome      of a cast: "contact", "grazing", "separated"; of a clearance: "blocked", "slides",
               "behind", "separated", "overlapping"; of parts: "free", "blocked", "overlapping"; of a
               distance: "apart", "meeting"; of a depth: "overlapping", "touching", "apart"; within:
               "closer", "farther", "undecided"; of a motion: "contact", "grazing", "free",
               "overlapping", "blocked", "undecided"; "error"
  time         of a motion: {"lower", "upper"}, from 0 at its start to 1 at its end
  direction    with --directions: the direction; of a depth: the unit vector of the shortest way out
  separating_translation  of parts that overlap: the shortest translation of the moving ones that was
               found to separate them, at most upper long
  lower upper  proven bounds of a distance or a depth; "closer" has only upper, "farther" only lower
  points       [moving, fixed]: the nearest points, in the world
  distance     of a clearance, blocked: safe travel, the lower bound of translation, never negative
  back on      of a clearance, overlapping: travel backwards or forwards after which they are free
  translation  first contact; negative: behind, or overlapping; of parts: of the nominal surfaces
  exit         last contact; behind: normal, point and features are those there
  offset_distance  of parts, blocked: travel of the bodies offset by half the tolerance each
  translation_bounds exit_bounds offset_distance_bounds
               proven [lower, upper]; null if unknown, for example of bodies that slide and may not
               touch. Of parts whose two faces pass each other, the upper bound of translation holds
               for the offset bodies
  rounding     of convex bodies: the part of the bounds' difference that is rounding
  tolerance    of parts: the tolerance used, each body is offset inwards by half of it
  min_gap         the minimum gap: the bodies count as meeting at this distance
  start_overlaps  of parts that overlap now: [{"moving", "fixed", "least_tolerance"}], the least
               tolerance with which they would not; absent if there is none
  surfaces     of parts: open bodies, ["moving", "fixed"]
  normal       unit normal from moving to fixed: of the contact plane, of the separating plane, or
               along the shortest way
  point        the contact point on the fixed body, in the world
  features     {"moving": {"kind": "vertex"|"edge"|"face", "vertices": [...]}, "fixed": ...}
  moving fixed of parts: the files that touch or are nearest, or overlap deepest
  margin       separated: lower bound of the distance of the projections along the direction
  overlap      grazing, slides: overlap of the projections; negative if they may not overlap
  sideways     grazing, slides: the unit vector across the direction along which they overlap
  hull         {"moving": EXCESS, "fixed": EXCESS} of hulls that differ from their meshes. EXCESS =
               {"hull_volume", "part_volume" (of a closed mesh), "depth" (of the deepest dent)}
  dents        {"moving": DEPTH, "fixed": DEPTH} of meshes that are convex only to the tolerance
  solver steps of convex bodies: the algorithm, and the work of the search
  message      the error; grazing: the direction in which the projections overlap
  notes        merged vertices, repaired meshes, normalised quaternions"#;

const JSON_ASSEMBLY: &str = r#"Answer of assembly:
  {"parts": [{"name", "facets", "volume", "volume_bounds", "fastener": {"kind", "size", "diameter", "length",
     "width", "axis", "words", "metric", "head", "drive", "pitch", "by_name"}}], "unit", "tolerance" (or "keep_apart"),
   "overlaps": [{"parts": [a, b], "least_tolerance", "remains"}], "suggested_tolerance",
   "suggestions": [{"parts", "role", "tolerance", "why"}], "pairs": [{"parts", "role", "words"}],
   "liaisons": [{"parts": [a, b], "area", "area_bounds", "center"}],
   "rooms": [{"part", "direction", "outcome", "distance", "by", "point", "normal", "translation",
     "translation_bounds", "offset_distance", "offset_distance_bounds" (or "kept_distance", ...)}],
   "plan": [{"parts": [...], "direction": [x, y, z], "travel", "travel_bounds",
     "path": [{"parts", "direction", "travel", "turn": {"point", "axis", "turns", "pitch", "phase",
       "aside", "words", "proof": {"tolerance", "pairs"} or "not_proven"}}], "back", "within",
     "ignored", "passed", "surfaces", "subassembly",
     "unscrew": {"length", "turns", "pitch", "standard", "words"},
     "tool": {"name", "reaches", "blockers", "words"}, "unproven": [why]}],
   "wanted" (of --remove): {"parts", "others", "fasteners", "obstacles", "least", "out"}, "rounds": [...],
   "assembly": [{"step", "after"}], "seconds": [...], "left": [...],
   "stuck": [{"parts", "because", "directions", "proof": {"proven": cells} or {"asked": directions},
     "moves": {"effort", "directions", "places", "complete"} or {"proven": cells} or
     {"enclosed": true} or {"not_asked": why}, "holds"}], "try": [{"option", "why"}], "maps": [...], "free": [...] (as `directions`, with "parts")}
  Directions have length 1. `distance` is safe to move by, proven. A step with "within" takes apart
  the group of that step, counted from 0. "path" lists its moves; the last one removes its parts.
  Parts that made room before go "back"."#;

pub(super) const ASSEMBLY_NOTES: &str = "\
With -o DIR: report.html, instructions.html (assembly, for print), bill.csv, disassembly.glb,
assembly.json, matrix.csv (blocking pairs), precedence.csv (steps), precedence.json (ways out of
each part), for each --map a .svg, .png and .json, for each --free its proof.

Examples:
    colltrans assembly parts/ -o plan
    colltrans assembly gearbox.step --remove bearing --free bearing --json

`colltrans help files`: manifest, formats, units, exit codes; `colltrans help json`: fields.";

pub(super) const AUDIT_NOTES: &str = "\
Findings, the worst first:
  interfering  the parts overlap, also after each is shrunk by half the tolerance; `depth` bounds the
               shortest translation that separates them, `translation` of the first part is the
               shortest one found
  contained    one part lies inside the other; their surfaces touch at points and edges at most
  touching     they are at most the tolerance apart, or the shrunk parts do not overlap, or their role
               permits it. Sharp tips are shrunk by more: up to 32 times as deep as the tolerance
  apart        they are nearer than the clearance
Text lists the violations: interfering (`by` the tolerance that would suffice), contained, or nearer
than the clearance. Parts that touch violate a clearance that is larger than their distance, except
with --allow-contact. Pairs with a role or a tolerance of their own (--press, --soft, --thread,
--snap, --fit) have no clearance, unless a --within names both parts: then they may not touch,
either. Pairs that are ignored or glued are left out.

With --json one object:
  parts unit tolerance notes   as of `assembly`
  within, levels, allow_contact   the clearance, those of groups ({\"groups\", \"length\"}), and whether
          parts that touch satisfy them
  counts  {\"examined\", \"ignored\", \"interfering\", \"contained\", \"touching\", \"near\", \"violations\"}
  pairs   [{\"parts\": [a, b], \"finding\", \"violation\", \"clearance\", \"tolerance\", \"role\"}] with
          - of touching and apart: \"distance\", \"points\";
          - of the others: \"depth\", \"translation\", \"volume\", \"box\", \"least_tolerance\", \"point\";
          - of contained also: \"inner\", \"wall\" (distance of both surfaces), \"wall_points\";
          - \"open\": the parts with open shells, whose volume and containment are those of closed shells;
          - with --proofs: \"proofs\", the file of each claim (\"distance\", \"depth\", \"common_part\"), and
            \"unproven\", the reason why a claim has no proof.
          Depths, distances, walls and volumes are proven [lower, upper].

Examples:
  Is anything nearer than 0.5, or interfering? Bolted faces may touch.
    colltrans audit gearbox/ --within 0.5 --allow-contact
  Pipes keep 50 from beams; the bush is pressed in by at most 0.04:
    colltrans audit plant.glb --within 2 --within 'pipe*,beam*=50' --fit bush,body=0.04 \\
      --csv clashes.csv

`colltrans help files`: sources, manifest, units, exit codes.";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrapped_texts_fit_the_width_and_keep_their_words() {
        let texts = [
            SEE_ALL,
            &mesh_files(),
            UNITS_AND_POSES,
            BODIES,
            LISTS,
            MANIFEST,
            EXIT_CODES,
            INFO_NOTES,
            CAST_NOTES,
            CLEARANCE_NOTES,
            DIRECTIONS_NOTES,
            DISTANCE_NOTES,
            DEPTH_NOTES,
            WITHIN_NOTES,
            MOTION_NOTES,
            PATH_NOTES,
            BATCH_FORMAT,
            JSON_FIELDS,
            JSON_ASSEMBLY,
            ASSEMBLY_NOTES,
            AUDIT_NOTES,
            VERIFY_NOTES,
            REPLAY_NOTES,
            SETUP_NOTES,
        ];
        let words = |text: &str| {
            let all = text.split_whitespace().filter(|word| *word != "\\");
            all.map(str::to_owned).collect::<Vec<_>>()
        };
        for text in texts {
            for width in [60, 80, 100] {
                let wrapped = wrap_paragraphs(text, width);
                let longest = wrapped.lines().max_by_key(|line| line.chars().count()).unwrap();
                assert!(longest.chars().count() <= width, "{longest}");
                assert_eq!(words(&wrapped), words(text));
            }
        }
        let explained = "  back on   travel backwards,\n            or forwards";
        assert_eq!(wrap_paragraphs(explained, 80), explained);
        let command = wrap_paragraphs("    colltrans cast peg.stl plate.stl --direction -z", 40);
        assert_eq!(command, "    colltrans cast peg.stl plate.stl \\\n      --direction -z");
    }
}

//! What `--help` says at length.

pub(super) const EXIT_CODES: &str = "\
Exit codes:
  0  answered (contact, grazing, separated are all answers)
  1  batch, --directions: some lines have no answer; the results say which and why
  2  the command line is wrong
  3  an input file cannot be read, a body is not what it should be, or an output would overwrite an
     input
  4  the query has no certified answer (please report the case)
  5  the output cannot be written";

pub(super) const FORMATS: &str = "\
Mesh files: STL (binary or text), OBJ, PLY and OFF, told by their extension. Lengths are in the unit
of the files; both meshes must have the same one (--moving-scale, --fixed-scale). Vertex indices in
answers count from 0 in the order of the file; the corners of STL triangles are merged where they
are equal, in the order of their first appearance.";

pub(super) const CAST_EXAMPLES: &str = "\
Examples:
  How far can a peg go down from 50 above a plate?
    colltrans cast peg.stl plate.stl --direction -z --moving-pose 0,0,50
  The peg is in inches and lies on its side; the plate has holes, so take its hull:
    colltrans cast peg.stl plate.stl --direction -z --moving-pose 0,0,50 --moving-rpy 90,0,0 \\
      --moving-scale 25.4 --hull-fixed --picture peg.svg
  Many directions, one JSON object a line:
    printf 'x\\n-x\\n1,1,0\\n' | colltrans cast a.obj b.obj --directions - --json";

pub(super) const CLEARANCE_ANSWERS: &str = "\
Answers:
  blocked      the body can go so far, and then touches the other; 0 if it touches now and would
               enter it
  slides       it can go on for ever: the bodies touch along the way, or overlap sideways by no
               more than --graze-tolerance
  behind       it can go on for ever: the bodies only meet behind
  separated    it can go on for ever, and back too: the bodies never meet along this line
  overlapping  the bodies overlap now; the answer says how far to go back, or on, to be free

Example:
  colltrans clearance drawer.stl cabinet.stl --direction -y --hull-moving";

pub(super) const BATCH_FORMAT: &str = r#"Each line of the queries is one JSON object:
  {"id": any, "moving": BODY, "fixed": BODY, "moving_pose": POSE, "fixed_pose": POSE,
   "direction": [x,y,z], "graze_tolerance": L, "solver": "auto"|"cta"|"portal"}
  BODY = {"points": [[x,y,z],...]} (their convex hull)
       or {"mesh": "path", "hull": true|false, "scale": FACTOR}
  (hull and scale may be missing: as --hull says, and 1)
  POSE = {"translation": [x,y,z], "rotation": [qx,qy,qz,qw]}, either may be missing
moving, fixed and direction are required. Paths are relative to the folder of the query file, or to
the current folder for standard input. Blank lines are skipped, unknown fields are errors.

Each result is one JSON object with those of these fields that apply:
  id           as in the query (null if it cannot be read)
  outcome      "contact", "grazing", "separated" or "error"; of `clearance`: "blocked", "slides",
               "behind", "separated" or "overlapping"
  direction    with --directions: the direction as it was read
  distance     of `clearance`, blocked: how far the body can go for certain
  back on      of `clearance`, overlapping: how far to go back, or on, to be free for certain
  translation  first contact, in multiples of the direction; negative: behind, or overlapping
  exit         last contact; behind: where that is (and normal, point, features are those there)
  tolerance    what rounding alone can make of upper - lower; digits below it are not known
  normal       unit normal from moving to fixed: of the contact plane, or of the separating plane
  point        the contact point on the fixed body, in the world
  lower upper  the proven bounds of translation: never above, never below the true one; upper is
               missing where bodies slide so lightly that they may not touch
  features     {"moving": {"kind": "vertex"|"edge"|"face", "vertices": [...]}, "fixed": ...} by the
               indices of the points or mesh vertices in the input
  margin       gap between the shadows (the projections along the direction), measured along
               normal: a lower bound of their distance; grazing: minus their overlap
  hull         {"moving": EXCESS, "fixed": EXCESS} where the hull of a mesh was taken that is not
               convex. EXCESS = {"hull_volume", "part_volume" (of a closed mesh), "depth"}: the
               largest depth of the mesh's surface below the hull's. Then "separated" holds for the
               parts too, and a translation is a lower bound: they meet no earlier, if at all.
  solver steps what narrowed the search, and how much work it was
  message      what is wrong; grazing: along which direction the shadows overlap

Translations, bounds and tolerance are in multiples of the direction, other lengths in the unit of
the meshes. Bodies that occur again are built once while they fit (--cache-bytes). A file of results
that exists is replaced when all lines are answered, and never if a query reads it. A line may have
up to 64 MiB."#;

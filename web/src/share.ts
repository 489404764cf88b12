// The question elsewhere: as a command, a Rust program, a Python program.

import type { Slot, Take } from "./engine";
import type { Vec } from "./math";
import type { State } from "./state";

const isHome = (pose: number[]) => pose.join() === "0,0,0,0,0,0,1";
export const quoted = (file: string) => (/^[\w./-]+$/.test(file) ? file : `'${file.replaceAll("'", String.raw`'\''`)}'`);
const isSolid = (take: Take) => take === "solid" || take === "open";
const files = (state: State): Record<Slot, string> => ({
  moving: state.parts.moving.file.split("/").at(-1)!,
  fixed: state.parts.fixed.file.split("/").at(-1)!,
});

/** Nothing where no command asks the same. */
export function asCommand(state: State): string | undefined {
  const { moving, fixed } = files(state);
  const solids = isSolid(state.parts.moving.take) || isSolid(state.parts.fixed.take);
  const hull = Object.values(state.parts).some(({ take }) => take === "hull");
  if (solids && hull) return undefined;
  const words = solids
    ? ["colltrans", "clear", quoted(moving), "--from", quoted(fixed)]
    : ["colltrans", "cast", quoted(moving), quoted(fixed)];
  words.push(`--direction=${state.direction.join(",")}`);
  for (const slot of ["moving", "fixed"] as const) {
    if (!isHome(state.poses[slot])) words.push(`--${slot}-pose=${state.poses[slot].join(",")}`);
    if (!solids && state.parts[slot].take === "hull") words.push(`--hull-${slot}`);
  }
  if (solids) {
    if (state.tolerance !== null) words.push(`--tolerance=${state.tolerance}`);
    if (state.ignore) words.push("--ignore-start-overlaps");
    if (state.parts.moving.take === "open" || state.parts.fixed.take === "open") words.push("--open");
  } else {
    if (state.graze) words.push(`--graze-tolerance=${state.graze}`);
    if (state.solver !== "auto") words.push(`--solver=${state.solver}`);
  }
  return words.join(" ");
}

/** A number as Rust and Python read it: the same bits, and always a float. */
function float(x: number): string {
  const text = String(x);
  return /[.e]/.test(text) ? text : `${text}.0`;
}

const list = (v: number[]) => v.map(float).join(", ");
const vector = (v: Vec) => `DVec3::new(${list(v)})`;

function rustPose(pose: number[]): string {
  if (isHome(pose)) return "Pose::IDENTITY";
  const turn = pose.slice(3).join() === "0,0,0,1" ? undefined : `DQuat::from_xyzw(${list(pose.slice(3))})`;
  const at = vector(pose.slice(0, 3) as Vec);
  return turn ? `Pose::new(${turn}, ${at})?` : `Pose::from_translation(${at})?`;
}

function rustBody(slot: Slot, state: State): string {
  const mesh = `    let mesh = colltrans_mesh::read(${JSON.stringify(files(state)[slot])})?;\n`;
  const build: Record<Take, string> = {
    convex: "ConvexPolyhedron::from_mesh(&mesh.vertices, &mesh.faces, 1e-5 * mesh.extent())?",
    hull: "ConvexPolyhedron::from_points(&mesh.vertices)?",
    solid: "Solid::from_mesh(&mesh.vertices, &mesh.faces)?",
    open: "Solid::from_open_mesh(&mesh.vertices, &mesh.faces)?",
  };
  const solids = isSolid(state.parts.moving.take) || isSolid(state.parts.fixed.take);
  const { take } = state.parts[slot];
  const made = solids && !isSolid(take) ? `Solid::from_convex(&${build[take]})?` : build[take];
  return `${mesh}    let ${slot} = ${made};\n`;
}

export function asRust(state: State): string {
  const solids = isSolid(state.parts.moving.take) || isSolid(state.parts.fixed.take);
  const turned = (["moving", "fixed"] as const).some((slot) => state.poses[slot].slice(3).join() !== "0,0,0,1");
  const hulls = (["moving", "fixed"] as const).some((slot) => !isSolid(state.parts[slot].take));
  const solver = { auto: "", cta: ".with_solver(Solver::Cta)", portal: ".with_solver(Solver::Portal)" }[state.solver];
  const names = ["Cast", hulls && "ConvexPolyhedron", "Pose", solids && "Solid", !solids && solver && "Solver"].filter(Boolean);
  if (solids && state.ignore) names.push("StartOverlap");
  const choices = solids
    ? (state.tolerance === null ? "" : `.with_tolerance(${float(state.tolerance)})?`) +
      (state.ignore ? ".with_start_overlap(StartOverlap::Ignore)" : "")
    : solver + (state.graze ? `.with_graze_tolerance(${float(state.graze)})?` : "");
  const first = state.poses;
  return `use colltrans::glam::${turned ? "{DQuat, DVec3}" : "DVec3"};
use colltrans::{${names.join(", ")}};

fn main() -> Result<(), Box<dyn std::error::Error>> {
${rustBody("moving", state)}${rustBody("fixed", state)}    let cast = Cast::new(
        moving.at(${rustPose(first.moving)}),
        fixed.at(${rustPose(first.fixed)}),
        ${vector(state.direction)},
    )?${choices};
    println!("{:#?}", cast.clearance()${solids ? "" : "?"});
    Ok(())
}
`;
}

function pythonBody(slot: Slot, state: State): string {
  const file = JSON.stringify(files(state)[slot]);
  const read: Record<Take, string> = {
    convex: `colltrans.read(${file})`,
    hull: `colltrans.read(${file}, hull=True)`,
    solid: `colltrans.Solid.read(${file})`,
    open: `colltrans.Solid.read(${file}, open=True)`,
  };
  return `${slot} = ${read[state.parts[slot].take]}\n`;
}

export function asPython(state: State): string {
  const solids = isSolid(state.parts.moving.take) || isSolid(state.parts.fixed.take);
  const named = [`[${list(state.direction)}]`];
  for (const slot of ["moving", "fixed"] as const) {
    if (!isHome(state.poses[slot])) named.push(`${slot}_pose=[${list(state.poses[slot])}]`);
  }
  if (solids) {
    if (state.tolerance !== null) named.push(`tolerance=${float(state.tolerance)}`);
    if (state.ignore) named.push("ignore_start_overlaps=True");
  } else {
    if (state.graze) named.push(`graze_tolerance=${float(state.graze)}`);
    if (state.solver !== "auto") named.push(`solver="${state.solver}"`);
  }
  const choices = named.map((one) => `    ${one},\n`).join("");
  const asked = solids ? "colltrans.SolidCast" : "colltrans.clearance";
  return `import colltrans

${pythonBody("moving", state)}${pythonBody("fixed", state)}answer = ${asked}(
    moving,
    fixed,
${choices})${solids ? ".clearance()" : ""}
print(answer)
`;
}

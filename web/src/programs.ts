// The question as a Rust or a Python program; loaded on demand.

import type { Slot, Take } from "./engine";
import type { Vec } from "./math";
import { files, isHome, isSolid } from "./share";
import type { State } from "./state";

/** Formats a number so that Rust and Python read the same bits, always as a float. */
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
  const { take } = state.parts[slot];
  const load = isSolid(take) ? "load_solid" : "load_convex";
  const given = { convex: "", hull: ".with_hull(true)", solid: "", open: ".with_open(true)" }[take];
  const read = `    let ${slot} = ${load}(${JSON.stringify(files(state)[slot])}, &BodyOptions::default()${given})?;\n`;
  const solids = Object.values(state.parts).some((part) => isSolid(part.take));
  return solids && !isSolid(take) ? `${read}    let ${slot}_body = Solid::from_convex(&${slot}.body)?;\n` : read;
}

export function asRust(state: State): string {
  const takes = [state.parts.moving.take, state.parts.fixed.take];
  const solids = takes.some(isSolid);
  const turned = (["moving", "fixed"] as const).some((slot) => state.poses[slot].slice(3).join() !== "0,0,0,1");
  const narrowed = state.solver === "cta" && (state.start !== "center" || state.until !== null);
  const from = { center: "cta::Start::Center", ellipsoids: "cta::Start::Ellipsoids" }[state.start];
  const until = state.until === null ? "cta::Until::Exit" : `cta::Until::Gap(${float(state.until)})`;
  const solver = narrowed
    ? `.with_options(Options::default().with_solver(Solver::Cta).with_narrowing(cta::Options::new(${from}, ${until})))?`
    : { auto: "", cta: ".with_solver(Solver::Cta)", portal: ".with_solver(Solver::Portal)" }[state.solver];
  const names = solids
    ? ["Pose", !takes.every(isSolid) && "Solid"]
    : ["Cast", narrowed && "Options", "Pose", solver && "Solver", narrowed && "cta"];
  const loads = ["BodyOptions", solids && "cast_between", !takes.every(isSolid) && "load_convex", solids && "load_solid"];
  const body = (slot: Slot) => (solids && !isSolid(state.parts[slot].take) ? `${slot}_body` : `${slot}.body`);
  const precision = (slot: Slot) => (isSolid(state.parts[slot].take) ? `${slot}.precision` : "0.0");
  const tolerance = state.tolerance === null ? "None" : `Some(${float(state.tolerance)})`;
  const more = solids
    ? `
        [${precision("moving")}, ${precision("fixed")}],
        ${tolerance},
        StartOverlap::${state.ignore ? "Ignore" : "Refuse"},`
    : "";
  const choices = solids ? "" : solver + (state.graze ? `.with_graze_tolerance(${float(state.graze)})?` : "");
  return `use colltrans::glam::${turned ? "{DQuat, DVec3}" : "DVec3"};
${solids ? "use colltrans::solid::StartOverlap;\n" : ""}use colltrans::{${names.filter(Boolean).join(", ")}};
use colltrans_mesh::body::{${loads.filter(Boolean).join(", ")}};

fn main() -> Result<(), Box<dyn std::error::Error>> {
${rustBody("moving", state)}${rustBody("fixed", state)}    let cast = ${solids ? "cast_between" : "Cast::new"}(
        ${body("moving")}.at(${rustPose(state.poses.moving)}),
        ${body("fixed")}.at(${rustPose(state.poses.fixed)}),
        ${vector(state.direction)},${more}
    )?${choices};
    println!("{:#?}", cast.clearance()?);
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
    const until = state.until === null ? [] : [`until=${float(state.until)}`];
    const cta = [...(state.start === "center" ? [] : [`start="${state.start}"`]), ...until].join(", ");
    if (state.solver === "cta" && cta) named.push(`solver=colltrans.Cta(${cta})`);
    else if (state.solver !== "auto") named.push(`solver="${state.solver}"`);
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

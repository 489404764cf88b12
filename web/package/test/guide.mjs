import { ConvexPolyhedron, Solid, cast, castMany, clearance, distance } from "colltrans";

// A cast: when does a box that moves along x meet another one?
const box = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1]);
const hit = cast(box.at([-3, 0.5, 0]), box, [1, 0, 0]);
console.log(hit.outcome, hit.value, hit.lower <= 2 && 2 <= hit.upper);

// The distance of two meshes: points, and triangles by their indices.
const points = [0, 0, 0, 4, 0, 0, 0, 4, 0, 0, 0, 4];
const tetrahedron = Solid.fromMesh(points, [0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3]);
console.log(distance(tetrahedron, box.at([-3, 0, 0])).value.toFixed(9));

// Is a part free to leave along d?
console.log(clearance(box.at([0, 0, 5]), tetrahedron, [0, 0, 1]).value === Infinity);

// Many casts in one call: typed arrays in and out.
const positions = Float64Array.of(0, 0, 5, 1, 0, 6, 9, 9, 7);
console.log(castMany(box, tetrahedron, [0, 0, -1], { movingPoses: { positions } }).value);

// Which surface is the nearest, sampled over the page.
//
// Notation. A point of the page is (x, y, q) in pixels, q the inverse of its distance along the
// view: planes of the scene are planes there. A *sample* is the middle of a cell of `1 / fine` pixels.
//
// Invariant: each sample holds the nearest q of all triangles drawn so far that cover it, and whose
// it is.

export interface Point {
  x: number;
  y: number;
  q: number;
}

export type Corners = readonly [Point, Point, Point];

/** Calls for every sample that a triangle covers, its rim included, with the q there. */
export function cover(corners: Corners, fine: number, wide: number, high: number, visit: (cell: number, q: number) => void) {
  const [a, b, c] = corners.map(({ x, y, q }) => ({ x: x * fine - 0.5, y: y * fine - 0.5, q })) as unknown as Corners;
  const [ux, uy, vx, vy] = [b.x - a.x, b.y - a.y, c.x - a.x, c.y - a.y];
  const twice = ux * vy - uy * vx;
  if (!twice || !Number.isFinite(twice)) return;
  const slopeX = ((b.q - a.q) * vy - (c.q - a.q) * uy) / twice;
  const slopeY = ((c.q - a.q) * ux - (b.q - a.q) * vx) / twice;
  // Of a triangle seen nearly from its edge the plane is steep, and q is what corners have at most.
  const [least, most] = [Math.min(a.q, b.q, c.q), Math.max(a.q, b.q, c.q)];
  const sides = [[a, b], [b, c], [c, a]] as const;
  const bottom = Math.min(high - 1, Math.floor(Math.max(a.y, b.y, c.y)));
  for (let y = Math.max(0, Math.ceil(Math.min(a.y, b.y, c.y))); y <= bottom; y++) {
    let [left, right] = [Infinity, -Infinity];
    for (const [p, r] of sides) {
      if (Math.min(p.y, r.y) > y || Math.max(p.y, r.y) < y) continue;
      for (const end of p.y === r.y ? [p.x, r.x] : [p.x + ((y - p.y) / (r.y - p.y)) * (r.x - p.x)]) {
        [left, right] = [Math.min(left, end), Math.max(right, end)];
      }
    }
    const last = Math.min(wide - 1, Math.floor(right));
    for (let x = Math.max(0, Math.ceil(left)); x <= last; x++) {
      const q = a.q + slopeX * (x - a.x) + slopeY * (y - a.y);
      visit(y * wide + x, Math.min(most, Math.max(least, q)));
    }
  }
}

export class Depths {
  private readonly nearest: Float64Array;
  private readonly owner: Int32Array;
  private readonly drawn = new Set<number>();
  private readonly wide: number;
  private readonly high: number;

  /** `slack`: lengths along the view that are no difference. */
  constructor(wide: number, high: number, private readonly slack: number, private readonly fine = 2) {
    [this.wide, this.high] = [Math.ceil(wide * fine), Math.ceil(high * fine)];
    this.nearest = new Float64Array(this.wide * this.high);
    this.owner = new Int32Array(this.wide * this.high).fill(-1);
  }

  draw(corners: Corners, owner: number) {
    this.drawn.add(owner);
    cover(corners, this.fine, this.wide, this.high, (cell, q) => {
      if (q > this.nearest[cell]!) [this.nearest[cell], this.owner[cell]] = [q, owner];
    });
  }

  /** Whether it was drawn. */
  has(owner: number): boolean {
    return this.drawn.has(owner);
  }

  /** The pieces of a segment that are seen: shares of it. At an edge of `owners` these do not hide it,
   * however steep they are. */
  seen(a: Point, b: Point, owners: readonly number[] = []): [number, number][] {
    const count = Math.min(1e4, Math.max(1, Math.ceil(this.fine * Math.hypot(b.x - a.x, b.y - a.y))));
    const pieces: [number, number][] = [];
    let start = -1;
    for (let k = 0; k <= count; k++) {
      const s = (k + 0.5) / count;
      const sees = k < count && this.sees({ x: a.x + s * (b.x - a.x), y: a.y + s * (b.y - a.y), q: a.q + s * (b.q - a.q) }, owners);
      if (sees && start < 0) start = k;
      if (!sees && start >= 0) {
        pieces.push([start / count, k / count]);
        start = -1;
      }
    }
    return pieces;
  }

  /** Whether any sample around a point lets it be seen; a point beside the page is not. */
  private sees({ x, y, q }: Point, owners: readonly number[]): boolean {
    const [column, row] = [Math.floor(x * this.fine), Math.floor(y * this.fine)];
    if (column < 0 || row < 0 || column >= this.wide || row >= this.high) return false;
    const nearer = 1 / (1 / q - this.slack);
    for (let j = Math.max(0, row - 1); j <= Math.min(this.high - 1, row + 1); j++) {
      for (let i = Math.max(0, column - 1); i <= Math.min(this.wide - 1, column + 1); i++) {
        const cell = j * this.wide + i;
        if (this.nearest[cell]! <= nearer || owners.includes(this.owner[cell]!)) return true;
      }
    }
    return false;
  }
}

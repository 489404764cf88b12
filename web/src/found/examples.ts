// Examples to show: one with many steps, and one for each of the paper's figures 1 to 10.

export interface Look {
  name: string;
  /** One of the page's examples. */
  example: string;
  /** Figure and section of the paper, if the example is about one. */
  figure?: string;
  text: string;
  /** The moment that is shown (everything before it has happened), and whether the graph has contours or is a surface. */
  at: "start" | "first touch" | "first shift" | "second step" | "end";
  surface?: boolean;
  /** Whether to show all levels instead of the remaining region. */
  whole?: boolean;
  /** The kind of planar problem to search for. */
  touch?: "edges" | "vertex" | "separated";
  start?: "region";
}

export const LOOKS: Look[] = [
  { name: "Many steps: two ellipsoids", example: "thirteen", at: "start", text: "Thirteen planar problems from the centre to the end. The picture follows the region that is left; press Play." },
  { name: "Figure 1: the convex function", example: "cubes", figure: "figure 1, section II-A", at: "first touch", surface: true, whole: true, text: "Each pair of sections of the two cubes has a translation φ until it touches. Over all pairs that is a convex surface, made of facets, and its lowest point is the collision of the cubes." },
  { name: "Figure 2: its mark", example: "cubes", figure: "figure 2, section II-B", at: "first touch", whole: true, text: "The facets, seen from above, are the cells of the mark. The yellow one is that of the pair in view: all its pairs touch with the same features, so the cut line has one orientation in all of it." },
  { name: "Figure 3: edge contact", example: "cubes", figure: "figure 3, section II-B a", at: "first touch", touch: "edges", whole: true, text: "An edge of one section touches an edge of the other: a face of each cube. The lowest common point of both shadows is where the two edges cross." },
  { name: "Figure 4: vertex contact", example: "corner", figure: "figure 4, section II-B b", at: "first touch", touch: "vertex", whole: true, text: "The lowest corner of one section falls inside the other: an edge of one cube against the whole section of the other." },
  { name: "Figure 5: separation", example: "beside", figure: "figure 5, section II-B c", at: "first touch", touch: "separated", whole: true, text: "The sections never meet, because their shadows have nothing in common: a line lies between them. The cut keeps the side where they come closer." },
  { name: "Figure 6: cells and sections", example: "cubes", figure: "figure 6, section II-B", at: "end", whole: true, text: "Step from one planar problem to the next: in each cell the sections look alike, and other features touch." },
  { name: "Figure 7: the algorithm", example: "thirteen", figure: "figure 7, section III-A", at: "start", text: "Each step is lines 4 to 8 of the paper’s program: a cut line at c, the shift to q, the test whether q solves the problem, the cut, the next centroid. Press Play, and read along." },
  { name: "Figure 8: from space to a plane", example: "cubes", figure: "figure 8, section III-B", at: "first touch", whole: true, text: "The moving section sweeps along d. Seen along d, both sections are polygons in one plane, and the contact is their lowest common point." },
  { name: "Figure 9: two minimisation steps", example: "cubes", figure: "figure 9, section III-C", at: "second step", whole: true, text: "At the centroid c the cut line is found, the shift goes to a better point q of the same cell, and the region is cut there. The second step finds the solution." },
  { name: "Figure 10: from the last solution", example: "thirteen", figure: "figure 10, section III-D", at: "end", start: "region", text: "The body moves a little at a time. Each search begins at the last solution p and stays in its neighbourhood N(p) while that has something left: it takes fewer steps." },
];

//! The paper's claims, one by one.

use super::Better::{Less, More, Neither};
use super::{PaperClaim, about, at_least, at_most, band, quoted};

/// All claims of the paper that are put to the test, in its order.
pub const CLAIMS: &[PaperClaim] = &[
    PaperClaim {
        id: "3-half",
        statement: "About half of the area of the region is discarded at each step.",
        paper: "about half",
        place: "III-A",
        criteria: &[about("share of the area that a cut leaves", 0.5, Less)],
    },
    PaperClaim {
        id: "3-sides",
        statement: "The region that contains the minimum is always bounded by few sides.",
        paper: "few",
        place: "V-A; at most 4 and one a step: III-A",
        criteria: &[
            at_most("sides at most, in 99 of 100 queries", 8.0),
            quoted("sides at most, on average"),
        ],
    },
    PaperClaim {
        id: "3-inside",
        statement: "With initialisation, the updated solution falls inside the neighbourhood of the last one with \
                    high probability.",
        paper: "high probability",
        place: "III-D",
        criteria: &[at_least("solutions in N(p), %", 90.0)],
    },
    PaperClaim {
        id: "3-steps",
        statement: "Without initialisation it takes 15 to 20 % fewer minimisation steps than the earlier method \
                    (of which the cuts are tried: through the centroid, not shifted).",
        paper: "15 to 20 %",
        place: "III, before III-A; reference [3]",
        criteria: &[band("fewer steps, %", [15.0, 20.0], More)],
    },
    PaperClaim {
        id: "3-calls",
        statement: "It invokes 9.6 to 10.2 fewer O(log n) algorithms than the earlier method, at any size (of which \
                    the cuts are tried).",
        paper: "9.6 to 10.2",
        place: "III, before III-A; reference [3]",
        criteria: &[band("fewer planar problems", [9.6, 10.2], More)],
    },
    PaperClaim {
        id: "11-steps",
        statement: "The average number of minimisation steps grows as the logarithm of the number of \
                    vertices.",
        paper: "log n",
        place: "V-A, figure 11",
        criteria: &[about("growth of steps / growth of log n, 200 to 200,000", 1.0, Less)],
    },
    PaperClaim {
        id: "11-few",
        statement: "Polyhedra of about 200,000 faces take fewer than 15 steps on average.",
        paper: "less than 15",
        place: "V-A, figure 11",
        criteria: &[at_most("steps at 200,000 vertices", 15.0)],
    },
    PaperClaim {
        id: "11-time",
        statement: "Query times follow log² n.",
        paper: "log² n",
        place: "V-A, figure 11",
        criteria: &[band("k in time ~ (log n)^k", [1.5, 2.5], Less)],
    },
    PaperClaim {
        id: "11-thin-stretch",
        statement: "Thin and stretched faces (a fixed stretch of 100) increase query times by 20 to 80 %.",
        paper: "20 to 80 %",
        place: "V-A",
        criteria: &[band("increase, % (middle of all sizes)", [20.0, 80.0], Less)],
    },
    PaperClaim {
        id: "11-thin-meridians",
        statement: "Thin and stretched faces (16 meridians) increase query times by 20 to 80 %.",
        paper: "20 to 80 %",
        place: "V-A",
        criteria: &[band("increase, % (middle of all sizes)", [20.0, 80.0], Less)],
    },
    PaperClaim {
        id: "table-1-planar",
        statement: "Almost half of the time goes into planar problems.",
        paper: "almost half",
        place: "V-A, table I",
        criteria: &[band("share of the time at 12,800 vertices, %", [37.5, 55.0], Neither)],
    },
    PaperClaim {
        id: "table-1-region",
        statement: "The time for the region that contains the minimum is negligible.",
        paper: "negligible",
        place: "V-A, table I",
        criteria: &[at_most("share of the time at most, of three sizes, %", 5.0)],
    },
    PaperClaim {
        id: "12-near",
        statement: "Bodies that pass each other at 0.005 diameters take almost half the time of \
                    bodies that collide.",
        paper: "almost halved",
        place: "V-B, figure 12",
        criteria: &[about("time / time of a collision", 0.5, Less)],
    },
    PaperClaim {
        id: "12-far",
        statement: "When they move far apart, at 1.5 diameters, the time reduces to about a third.",
        paper: "about 1/3",
        place: "V-B, figure 12",
        criteria: &[about("time / time of a collision", 1.0 / 3.0, Less)],
    },
    PaperClaim {
        id: "13-floor",
        statement: "With initialisation, several computations are completed in one minimisation step, \
                    the floor of the plots.",
        paper: "several",
        place: "V-C and V-F, figure 13",
        criteria: &[at_least("queries of one step at a change of 0.25 %, %", 10.0)],
    },
    PaperClaim {
        id: "13-adapts",
        statement: "The algorithm adapts to coherence: fewer steps with initialisation than without, \
                    and fewer at a change of 0.25 % than at 1 %.",
        paper: "gradually",
        place: "V-C, figure 13",
        criteria: &[
            at_most("steps at 1 % / steps from scratch", 1.0),
            at_most("steps at 0.25 % / steps at 1 %", 1.0),
        ],
    },
    PaperClaim {
        id: "13-motion",
        statement: "It does not depend on the type of motion: translation, rotation or screw.",
        paper: "do not depend",
        place: "V-C",
        criteria: &[at_most("steps of the motion with most / with fewest", 1.25)],
    },
    PaperClaim {
        id: "14-regular",
        statement: "The average number of steps decreases regularly as coherence grows.",
        paper: "decreases regularly",
        place: "I and V-C, figure 14",
        criteria: &[at_most("largest rise from a change to half of it, factor", 1.1)],
    },
    PaperClaim {
        id: "14-one",
        statement: "It gets very close to the smallest possible value, one step.",
        paper: "very close to 1",
        place: "I, figure 14",
        criteria: &[at_most("steps at a change of 0.0625 %, mean of all sizes", 1.5)],
    },
    PaperClaim {
        id: "14-log",
        statement: "It follows the estimate: linear in the logarithm of the change, above the floor of one step.",
        paper: "good accordance",
        place: "III-D and V-C, figure 14",
        criteria: &[at_least("R² of the law above its floor", 0.9)],
    },
    PaperClaim {
        id: "15-growth",
        statement: "Balanced: the cost of EGJK grows linearly, that of CTA and of PQP less.",
        paper: "linear; sublinear",
        place: "V-D, figure 15",
        criteria: &[
            about("exponent of EGJK, linear support search, from 3,200 vertices", 1.0, Neither),
            at_most("exponent of CTA", 0.75),
            at_most("exponent of PQP", 0.75),
        ],
    },
    PaperClaim {
        id: "15-egjk",
        statement: "Balanced: time(EGJK)/time(CTA) increases from about 1/5.",
        paper: "1/5, rising",
        place: "V-D, figure 15",
        criteria: &[
            about("ratio at 200 vertices, EGJK with linear support search", 0.2, More),
            at_least("its growth to 200,000 vertices, factor", 1.0),
            quoted("ratio at 200 vertices, EGJK climbing"),
        ],
    },
    PaperClaim {
        id: "15-fastest",
        statement: "Balanced: CTA is the fastest from about 20,000 vertices (EGJK with linear support \
                    search, which grows as the paper's).",
        paper: "20,000",
        place: "V-D, figure 15",
        criteria: &[
            at_least("time(EGJK)/time(CTA) at 51,200", 1.0),
            at_least("time(PQP)/time(CTA) at 51,200", 1.0),
        ],
    },
    PaperClaim {
        id: "15-fastest-climbing",
        statement: "Balanced: CTA is faster than EGJK from about 20,000 vertices (EGJK climbing to \
                    support points).",
        paper: "20,000",
        place: "V-D, figure 15",
        criteria: &[at_least("time(EGJK)/time(CTA) at 51,200", 1.0)],
    },
    PaperClaim {
        id: "15-pqp-trapezoids",
        statement: "Balanced trapezoids: time(PQP)/time(CTA) is in a band between 6.5 and 10.",
        paper: "6.5 to 10",
        place: "V-D, figure 15",
        criteria: &[band("middle of all sizes", [6.5, 10.0], More)],
    },
    PaperClaim {
        id: "15-pqp-triangles",
        statement: "Balanced triangles: time(PQP)/time(CTA) is around 5.5.",
        paper: "5.5",
        place: "V-D, figure 15",
        criteria: &[about("middle of all sizes", 5.5, More)],
    },
    PaperClaim {
        id: "16-egjk-stretch",
        statement: "Thin faces (a fixed stretch of 100): time(EGJK)/time(CTA) rises from about 1/5 to about 14.",
        paper: "1/5 to 14",
        place: "V-D, figure 16",
        criteria: &[
            about("ratio at 200 vertices, EGJK with linear support search", 0.2, More),
            about("ratio at 200,000 vertices", 14.0, More),
            quoted("ratio at 200,000 vertices, EGJK climbing"),
        ],
    },
    PaperClaim {
        id: "16-pqp-stretch",
        statement: "Thin faces (a fixed stretch of 100): time(PQP)/time(CTA) jumps to over 100.",
        paper: "over 100",
        place: "V-D, figure 16",
        criteria: &[at_least("largest ratio of all sizes", 100.0)],
    },
    PaperClaim {
        id: "16-pqp-growth-stretch",
        statement: "Thin faces (a fixed stretch of 100): PQP no longer follows a sublinear trend.",
        paper: "not sublinear",
        place: "V-D, figure 16",
        criteria: &[at_least("exponent of PQP, from 3,200 vertices", 0.9)],
    },
    PaperClaim {
        id: "16-egjk-meridians",
        statement: "Thin faces (16 meridians): time(EGJK)/time(CTA) rises from about 1/5 to about 14.",
        paper: "1/5 to 14",
        place: "V-D, figure 16",
        criteria: &[
            about("ratio at 200 vertices, EGJK with linear support search", 0.2, More),
            about("ratio at 200,000 vertices", 14.0, More),
            quoted("ratio at 200,000 vertices, EGJK climbing"),
        ],
    },
    PaperClaim {
        id: "16-pqp-meridians",
        statement: "Thin faces (16 meridians): time(PQP)/time(CTA) jumps to over 100.",
        paper: "over 100",
        place: "V-D, figure 16",
        criteria: &[at_least("largest ratio of all sizes", 100.0)],
    },
    PaperClaim {
        id: "16-pqp-growth-meridians",
        statement: "Thin faces (16 meridians): PQP no longer follows a sublinear trend.",
        paper: "not sublinear",
        place: "V-D, figure 16",
        criteria: &[at_least("exponent of PQP, from 3,200 vertices", 0.9)],
    },
    PaperClaim {
        id: "17-fastest-stretch",
        statement: "Thin faces (a fixed stretch of 100), bodies that pass within 1 % of a diameter: CTA is the fastest (EGJK \
                    with linear support search).",
        paper: "lowest",
        place: "V-D, figure 17",
        criteria: &[
            at_least("time(EGJK)/time(CTA) at 51,200", 1.0),
            at_least("time(PQP)/time(CTA) at 51,200", 1.0),
        ],
    },
    PaperClaim {
        id: "17-fastest-stretch-climbing",
        statement: "Thin faces (a fixed stretch of 100), bodies that pass within 1 % of a diameter: CTA is faster than EGJK \
                    (climbing to support points).",
        paper: "lowest",
        place: "V-D, figure 17",
        criteria: &[at_least("time(EGJK)/time(CTA) at 51,200", 1.0)],
    },
    PaperClaim {
        id: "17-fastest-meridians",
        statement: "Thin faces (16 meridians), bodies that pass within 1 % of a diameter: CTA is the fastest (EGJK \
                    with linear support search).",
        paper: "lowest",
        place: "V-D, figure 17",
        criteria: &[
            at_least("time(EGJK)/time(CTA) at 51,200", 1.0),
            at_least("time(PQP)/time(CTA) at 51,200", 1.0),
        ],
    },
    PaperClaim {
        id: "17-fastest-meridians-climbing",
        statement: "Thin faces (16 meridians), bodies that pass within 1 % of a diameter: CTA is faster than EGJK \
                    (climbing to support points).",
        paper: "lowest",
        place: "V-D, figure 17",
        criteria: &[at_least("time(EGJK)/time(CTA) at 51,200", 1.0)],
    },
    PaperClaim {
        id: "18-range",
        statement: "Incremental: time(CTA)/time(EGJK) varies from about 10 to 2.",
        paper: "10 to 2",
        place: "V-D, figure 18",
        criteria: &[
            about("largest of all sizes and changes", 10.0, Less),
            about("smallest", 2.0, Less),
        ],
    },
    PaperClaim {
        id: "18-egjk",
        statement: "The ratio keeps favourable to EGJK.",
        paper: "above 1",
        place: "V-D, figure 18",
        criteria: &[band("smallest ratio", [1.0, f64::INFINITY], Less)],
    },
    PaperClaim {
        id: "18-change",
        statement: "The ratio decreases for shorter incremental changes.",
        paper: "decreases",
        place: "V-D, figure 18",
        criteria: &[at_most("ratio at 0.13 % / ratio at 1 %, middle of all sizes", 1.0)],
    },
    PaperClaim {
        id: "18-size",
        statement: "The ratio decreases for more complex polyhedra.",
        paper: "decreases",
        place: "V-D, figure 18",
        criteria: &[at_most("ratio at 51,200 / ratio at 200 vertices, middle of all changes", 1.0)],
    },
    PaperClaim {
        id: "18-faces-stretch",
        statement: "Balanced and thin faces (a fixed stretch of 100) do not differ significantly.",
        paper: "no difference",
        place: "V-D, figure 18",
        criteria: &[band("ratio of thin / ratio of balanced", [0.75, 1.25], Less)],
    },
    PaperClaim {
        id: "18-faces-meridians",
        statement: "Balanced and thin faces (16 meridians) do not differ significantly.",
        paper: "no difference",
        place: "V-D, figure 18",
        criteria: &[band("ratio of thin / ratio of balanced", [0.75, 1.25], Less)],
    },
    PaperClaim {
        id: "19-affects",
        statement: "The initialisation parameters clearly affect the performance when coherence is \
                    very high.",
        paper: "clearly",
        place: "V-E, figure 19",
        criteria: &[
            at_least("CTA, worst parameter over the best, up to 0.5°, %", 20.0),
            at_least("H-Walk, the same, %", 20.0),
        ],
    },
    PaperClaim {
        id: "19-strong",
        statement: "Beyond 30 degrees strong initialisation does not significantly improve the \
                    performance, or worsens it.",
        paper: "none",
        place: "V-E, figure 19",
        criteria: &[
            at_least("CTA, strongest over no initialisation", 0.9),
            at_least("H-Walk, the same", 0.9),
        ],
    },
    PaperClaim {
        id: "19-worsening-800",
        statement: "At low coherence, 800 vertices, the parameter worsens CTA by about 35 %, and by less than H-Walk: \
                    it adapts better.",
        paper: "35 % against 65 %",
        place: "V-E, figure 19",
        criteria: &[
            about("CTA, worst parameter over the best, %", 35.0, Less),
            at_most("CTA's / H-Walk's", 1.0),
        ],
    },
    PaperClaim {
        id: "19-worsening-800-walk",
        statement: "At low coherence, 800 vertices, the parameter worsens H-Walk by about 65 %.",
        paper: "65 %",
        place: "V-E, figure 19",
        criteria: &[about("H-Walk, worst parameter over the best, %", 65.0, Neither)],
    },
    PaperClaim {
        id: "19-worsening-3200",
        statement: "At low coherence, 3,200 vertices, it worsens CTA by about 25 %, and by less than H-Walk.",
        paper: "25 % against 80 %",
        place: "V-E, figure 19",
        criteria: &[
            about("CTA, worst parameter over the best, %", 25.0, Less),
            at_most("CTA's / H-Walk's", 1.0),
        ],
    },
    PaperClaim {
        id: "19-worsening-3200-walk",
        statement: "At low coherence, 3,200 vertices, it worsens H-Walk by about 80 %.",
        paper: "80 %",
        place: "V-E, figure 19",
        criteria: &[about("H-Walk, worst parameter over the best, %", 80.0, Neither)],
    },
    PaperClaim {
        id: "19-dispersion-high",
        statement: "At high coherence the deviation over the mean of single runs is about 70 % with CTA, and more than \
                    with H-Walk.",
        paper: "70 % against 14 %",
        place: "V-E, figure 19",
        criteria: &[
            about("CTA, %", 70.0, Less),
            band("CTA's / H-Walk's", [1.0, f64::INFINITY], Less),
        ],
    },
    PaperClaim {
        id: "19-dispersion-high-walk",
        statement: "At high coherence it is about 14 % with H-Walk.",
        paper: "14 %",
        place: "V-E, figure 19",
        criteria: &[about("H-Walk, %", 14.0, Neither)],
    },
    PaperClaim {
        id: "19-dispersion-low",
        statement: "At low coherence it is about 35 % with CTA, and more than with H-Walk.",
        paper: "35 % against 4 %",
        place: "V-E, figure 19",
        criteria: &[
            about("CTA, %", 35.0, Less),
            band("CTA's / H-Walk's", [1.0, f64::INFINITY], Less),
        ],
    },
    PaperClaim {
        id: "19-dispersion-low-walk",
        statement: "At low coherence it is about 4 % with H-Walk.",
        paper: "4 %",
        place: "V-E, figure 19",
        criteria: &[about("H-Walk, %", 4.0, Neither)],
    },
];

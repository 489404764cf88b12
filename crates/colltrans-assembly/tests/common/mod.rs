//! Parts of boxes.

#![allow(dead_code, unreachable_pub, reason = "each test program uses a part of it")]

use colltrans_assembly::{Assembly, Part, Piece};
use colltrans_testkit::random::Random;
use glam::{DAffine3, DVec3};

pub fn cuboid(low: [f64; 3], high: [f64; 3]) -> Piece {
    let corner = |k: usize| {
        DVec3::from_array(std::array::from_fn(|i| if k >> i & 1 == 1 { high[i] } else { low[i] }))
    };
    let faces =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    Piece {
        vertices: (0..8).map(corner).collect(),
        faces: faces.iter().map(|f| f.to_vec()).collect(),
        world_from_piece: DAffine3::IDENTITY,
    }
}

/// Four walls and a floor around a hole, open at the top.
pub fn well(low: [f64; 3], high: [f64; 3], wall: f64) -> Vec<Piece> {
    let ([a, b, c], [x, y, z]) = (low, high);
    vec![
        cuboid([a - wall, b - wall, c - wall], [x + wall, y + wall, c]),
        cuboid([a - wall, b - wall, c - wall], [a, y + wall, z]),
        cuboid([x, b - wall, c - wall], [x + wall, y + wall, z]),
        cuboid([a - wall, b - wall, c - wall], [x + wall, b, z]),
        cuboid([a - wall, y, c - wall], [x + wall, y + wall, z]),
    ]
}

pub fn part(name: &str, pieces: &[Piece]) -> Part {
    Part::new(name, pieces).unwrap()
}

pub fn turned(name: &str, pieces: &[Piece], world: DAffine3) -> Part {
    let turned = |p: &Piece| Piece { world_from_piece: world, ..p.clone() };
    Part::new(name, &pieces.iter().map(turned).collect::<Vec<_>>()).unwrap()
}

/// Two links of a chain.
pub fn links() -> [Part; 2] {
    let a = [
        cuboid([-2.0, -2.0, -0.5], [-1.0, 2.0, 0.5]),
        cuboid([1.0, -2.0, -0.5], [2.0, 2.0, 0.5]),
        cuboid([-2.0, -2.0, -0.5], [2.0, -1.0, 0.5]),
        cuboid([-2.0, 1.0, -0.5], [2.0, 2.0, 0.5]),
    ];
    let b = [
        cuboid([-0.5, -0.5, -2.5], [0.5, 0.5, 2.5]),
        cuboid([3.0, -0.5, -2.5], [4.0, 0.5, 2.5]),
        cuboid([-0.5, -0.5, -2.5], [4.0, 0.5, -1.5]),
        cuboid([-0.5, -0.5, 1.5], [4.0, 0.5, 2.5]),
    ];
    [part("a", &a), part("b", &b)]
}

/// A core in a box with a lid on it, without any play.
pub fn boxed() -> Assembly {
    let parts = vec![
        part("box", &well([0.0; 3], [3.0; 3], 1.0)),
        part("core", &[cuboid([0.0; 3], [3.0, 3.0, 2.5])]),
        part(
            "lid",
            &[cuboid([-1.0, -1.0, 3.0], [4.0, 4.0, 3.5]), cuboid([0.0, 0.0, 2.5], [3.0; 3])],
        ),
    ];
    Assembly::new(parts).unwrap()
}

/// Boxes here and there, some of which overlap; with equal coordinates if snapped.
pub fn scattered(random: &mut Random, count: usize, snapped: bool) -> Assembly {
    let mut point = |scale: f64| {
        let p = DVec3::from_array([0; 3].map(|_| scale * (random.unit() - 0.5)));
        if snapped { p.round() } else { p }
    };
    let mut parts = Vec::new();
    for k in 0..count {
        let low = point(8.0);
        let high = low + point(3.0).abs() + 1.0;
        parts.push(part(&format!("p{k}"), &[cuboid(low.to_array(), high.to_array())]));
    }
    Assembly::new(parts).unwrap()
}

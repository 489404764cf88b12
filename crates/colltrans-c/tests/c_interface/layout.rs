//! The layout of all structs: the sizes and offsets that C sees are those of Rust.

use std::fmt::Write as _;
use std::fs;
use std::mem::offset_of;
use std::process::Command;

use colltrans_c::{
    BodyProperties, CastAnswer, CastColumns, CastOptions, DepthAnswer, DistanceAnswer,
    DistanceColumns, Feature, MotionAnswer, Pose, Rows,
};

use crate::header::{Kind, c_name, crate_folder, items};
use crate::programs::{Language, compilers, succeed, temporary};

/// Writes one line for each struct and field: its name, and its size or offset.
macro_rules! layouts {
    ($($name:ident: $($field:ident)*;)*) => {{
        let mut lines = String::new();
        $(
            writeln!(lines, "{} {}", c_name(stringify!($name)), size_of::<$name>()).unwrap();
            $(writeln!(lines, " {} {}", stringify!($field), offset_of!($name, $field)).unwrap();)*
        )*
        lines
    }};
}

fn layout_in_rust() -> String {
    layouts! {
        Pose: rotation translation;
        BodyProperties: is_convex is_closed vertex_count face_count radius volume;
        Feature: kind vertices;
        CastAnswer: outcome distance translation translation_lower translation_upper exit exit_lower exit_upper back on
            overlap margin rounding tolerance least_tolerance normal point_on_moving point_on_fixed moving_feature
            fixed_feature;
        DistanceAnswer: outcome lower upper normal point_on_moving point_on_fixed moving_feature fixed_feature;
        DepthAnswer: outcome lower upper least_tolerance direction;
        MotionAnswer: outcome time_lower time_upper tolerance least_tolerance normal point moving_feature fixed_feature;
        CastColumns: status outcome distance translation translation_lower translation_upper exit exit_lower exit_upper
            back on overlap margin rounding tolerance least_tolerance normal point_on_moving point_on_fixed
            moving_feature fixed_feature;
        DistanceColumns: status outcome lower upper normal point_on_moving point_on_fixed moving_feature fixed_feature;
        CastOptions: min_gap graze_tolerance tolerance before has_tolerance has_before ignore_start_overlap solver
            features;
        Rows: count moving_poses moving_pose_count fixed_poses fixed_pose_count directions direction_count threads;
    }
}

#[test]
fn structs_have_the_same_layout_in_c_and_rust() {
    let mut program =
        String::from("#include <colltrans.h>\n#include <stdio.h>\nint main(void) {\n");
    for item in items() {
        if let Kind::Struct { name, fields } = item.kind {
            let name = c_name(&name);
            writeln!(program, "printf(\"{name} %d\\n\", (int)sizeof({name}));").unwrap();
            for (_, field, _) in fields {
                let offset = format!("(int)offsetof({name}, {field})");
                writeln!(program, "printf(\" {field} %d\\n\", {offset});").unwrap();
            }
        }
    }
    program += "return sizeof(colltrans_status) != 4 || sizeof(colltrans_outcome) != 4;\n}\n";
    let folder = temporary("layout");
    fs::write(folder.join("layout.c"), program).expect("the program is written");
    for compiler in compilers(Language::C) {
        let mut command = Command::new(compiler);
        command.arg("-I").arg(crate_folder().join("include")).current_dir(&folder);
        succeed(command.args(["layout.c", "-o", "layout"]));
        let found = succeed(&mut Command::new(folder.join("layout")));
        assert_eq!(found, layout_in_rust(), "{compiler}");
    }
}

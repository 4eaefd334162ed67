//! The URDF of a run: links of the limb, obstacles, regions, carried objects.

use super::frames::{carried_frame, difference, solid_frame, solid_pose};
use crate::record::drawn::{BASE, TIP, WORLD, connector_frame, link_frame};
use crate::record::{CarriedInfo, DrawnLimb, Pose, RunInfo, SolidInfo, SolidShape};
use std::fmt::Write;

/// Colors, red, green, blue, opacity: told apart with every kind of color vision.
const MOVING: [f32; 4] = [0.0, 0.45, 0.70, 1.0];
const RIGID: [f32; 4] = [0.20, 0.22, 0.25, 1.0];
const OBSTACLE: [f32; 4] = [0.80, 0.26, 0.09, 1.0];
const REGION: [f32; 4] = [0.09, 0.31, 0.26, 0.25];
const CARRIED: [f32; 4] = [0.47, 0.09, 0.43, 1.0];
/// Thickness of the drawn base over the radius of the first link.
const BASE_THICKNESS: f64 = 0.3;

/// The description. Its frames are all children of the world: `/tf` moves those that are joined as `floating`.
pub(super) fn urdf(info: &RunInfo, limb: &DrawnLimb) -> String {
    let mut text = String::from("<?xml version=\"1.0\"?>\n");
    // Writing to a string cannot fail.
    let _ = writeln!(text, "<robot name=\"{}\">\n<link name=\"{WORLD}\"/>", escaped(&info.scene_name));
    let materials =
        [("moving", MOVING), ("rigid", RIGID), ("obstacle", OBSTACLE), ("region", REGION), ("carried", CARRIED)];
    for (name, [red, green, blue, opacity]) in materials {
        let _ = writeln!(text, "<material name=\"{name}\"><color rgba=\"{red} {green} {blue} {opacity}\"/></material>");
    }
    let radius_m = limb.links.first().map_or(0.0, |link| link.radius_m);
    let thickness_m = BASE_THICKNESS * radius_m;
    let plate = visual("rigid", &cylinder(radius_m, thickness_m), [0.0, 0.0, -0.5 * thickness_m]);
    part(&mut text, BASE, &plate, Some(&limb.base));
    for (index, link) in limb.links.iter().enumerate() {
        let material = if link.rigid { "rigid" } else { "moving" };
        let shape = visual(material, &cylinder(link.radius_m, link.length_m), [0.0; 3]);
        part(&mut text, &link_frame(index), &shape, None);
    }
    for name in &limb.modules {
        part(&mut text, &connector_frame(name), "", None);
    }
    part(&mut text, TIP, "", None);
    for solid in &info.solids {
        if let Some(pose) = solid_pose(solid) {
            part(&mut text, &solid_frame(solid), &solid_shape(solid), Some(&pose));
        }
    }
    for (index, object) in info.carried.iter().enumerate() {
        // An object that is carried twice is one object.
        if !info.carried[..index].iter().any(|before| before.name == object.name) {
            part(&mut text, &carried_frame(&object.name), &object_shape(object), None);
        }
    }
    text.push_str("</robot>\n");
    text
}

/// A link and the joint that hangs it into the world: at a fixed pose, or wherever `/tf` has it.
fn part(text: &mut String, frame: &str, visuals: &str, fixed: Option<&Pose>) {
    let frame = escaped(frame);
    let kind = if fixed.is_some() { "fixed" } else { "floating" };
    let origin = fixed.map_or(String::new(), |pose| {
        let ([x, y, z], [roll, pitch, yaw]) = (pose.position_m, angles(pose.rotation));
        format!("<origin xyz=\"{x} {y} {z}\" rpy=\"{roll} {pitch} {yaw}\"/>")
    });
    let _ = writeln!(
        text,
        "<link name=\"{frame}\">{visuals}</link>\n<joint name=\"{frame}_joint\" type=\"{kind}\"><parent link=\"{WORLD}\"/>\
         <child link=\"{frame}\"/>{origin}</joint>"
    );
}

fn visual(material: &str, geometry: &str, [x, y, z]: [f64; 3]) -> String {
    format!(
        "<visual><origin xyz=\"{x} {y} {z}\" rpy=\"0 0 0\"/><geometry>{geometry}</geometry><material name=\"{material}\"/></visual>"
    )
}

fn cylinder(radius_m: f64, length_m: f64) -> String {
    format!("<cylinder radius=\"{radius_m}\" length=\"{length_m}\"/>")
}

/// A solid in its own frame: the middle, with the line of a capsule or the axes of a box along the axes.
fn solid_shape(solid: &SolidInfo) -> String {
    let material = if solid.region { "region" } else { "obstacle" };
    let sphere = |radius_m: f64, at: f64| visual(material, &format!("<sphere radius=\"{radius_m}\"/>"), [0.0, 0.0, at]);
    match &solid.shape {
        None => String::new(),
        Some(SolidShape::Sphere { radius_m, .. }) => sphere(*radius_m, 0.0),
        Some(SolidShape::Capsule { from_m, to_m, radius_m }) => {
            let length_m = difference(*to_m, *from_m).norm();
            let [start, end] = [-0.5, 0.5].map(|side| sphere(*radius_m, side * length_m));
            visual(material, &cylinder(*radius_m, length_m), [0.0; 3]) + &start + &end
        }
        Some(SolidShape::Box { half_axes_m, .. }) => {
            let [x, y, z] = half_axes_m.map(|axis| 2.0 * nalgebra::Vector3::from(axis).norm());
            visual(material, &format!("<box size=\"{x} {y} {z}\"/>"), [0.0; 3])
        }
    }
}

/// An object about the place where the tip holds it.
fn object_shape(object: &CarriedInfo) -> String {
    let height_m = object.above_m + object.below_m;
    visual("carried", &cylinder(object.radius_m, height_m), [0.0, 0.0, 0.5 * (object.above_m - object.below_m)])
}

/// Angles about the fixed axes x, y and z, rad, in this order, as URDF has them.
fn angles([x, y, z, w]: [f64; 4]) -> [f64; 3] {
    let rotation = nalgebra::UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(w, x, y, z));
    let (roll, pitch, yaw) = rotation.euler_angles();
    [roll, pitch, yaw]
}

/// Text inside an attribute.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[test]
fn tmp() {
    for name in ["pick-and-place-b", "open/group-b", "open/loaded-group-b"] {
        let file = format!("{}/../../scenes/{name}.toml", env!("CARGO_MANIFEST_DIR"));
        let scene = softlimb_scene::load(&file).unwrap_or_else(|error| panic!("{error}"));
        let limb = softlimb_limb::Limb::new(&scene).expect("a limb");
        let m = &limb.modules()[0];
        let t = std::time::Instant::now();
        let _ = m.curve.restrained(&m.actuator, &m.positions_m(), 0.24);
        println!("{name} {:?} limit {:?} end {} nodes {}", t.elapsed(), m.curve.limit_point_pa(), m.curve.pressure_max_pa(), m.curve.states().len());
        for share in 28..=32 {
            let p = m.curve.pressure_max_pa() * f64::from(share) / 32.0;
            let s = m.curve.at(p);
            let free = m.actuator.forward(p, &fra_model::Load::none()).unwrap().state;
            println!("{p:.0} {:.5} {:.3} deg free {:.5} {:.3} deg lean {:.4}", s.axial_stretch, s.twist_rad.to_degrees(), free.axial_stretch, free.twist_rad.to_degrees(), 2.0 * m.reach_m() * (0.5*s.twist_rad).sin() / m.length_m() / s.axial_stretch);
        }
    }
}

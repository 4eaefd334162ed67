//! Linear laws, whose rods have independent solutions.

use softlimb_body::{Curve, Law, Main, Potential, Stiffness, Term};

/// Springs of a tube and what a pressure changes: stretch or bend rate without load by a pascal.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Springs {
    pub(crate) axial_n: f64,
    pub(crate) bending_nm2: [f64; 2],
    pub(crate) torsion_nm2: f64,
    pub(crate) shear_n: f64,
    pub(crate) by_pressure: f64,
}

impl Springs {
    pub(crate) fn law(&self, main: Main) -> Law {
        let own = match main {
            Main::Bend => self.bending_nm2[0],
            Main::Stretch | Main::Twist => self.axial_n,
        };
        let term = |powers, coefficient| Term { powers, coefficient };
        let points: Vec<[f64; 2]> =
            (0..3).map(|k| [f64::from(k) * self.by_pressure * 1e5, f64::from(k) * 1e5]).collect();
        Law {
            main,
            sign: 1.0,
            potential: Potential {
                units: [1.0; 3],
                range: [[-1e3, 1e3]; 2],
                terms: vec![term([2, 0, 0], 0.5 * own), term([1, 0, 1], -own * self.by_pressure)],
            },
            stiffness: Stiffness {
                unit_pa: 1.0,
                bending_nm2: self.bending_nm2.map(|value| vec![value]),
                torsion_nm2: vec![self.torsion_nm2],
                strip_n: self.axial_n,
                shear_n: self.shear_n,
            },
            elastic: Curve::rising(&points).unwrap(),
            filled: None,
        }
    }
}

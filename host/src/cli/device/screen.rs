//! The screen of `device monitor`: one row a channel, drawn over the last one.

use std::collections::VecDeque;
use std::fmt::Write;

use super::monitor::Line;
use softlimb_rig::link::DeviceFault;

/// Eighths of a row.
const BARS: [char; 8] = ['▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];
/// Pressures that a row remembers.
const MEMORY: usize = 40;
/// Least pressure of a full bar, Pa: noise at rest is no mountain.
const FULL_MIN_PA: f64 = 10e3;
/// Faults shown below the rows.
const FAULTS: usize = 5;

/// Control codes of a terminal: so many rows up; clear from here to the end.
const UP: &str = "\u{1b}[";
const CLEAR: &str = "\u{1b}[J";

/// What the screen remembers.
#[derive(Default)]
pub(super) struct Screen {
    pressures_pa: Vec<VecDeque<f64>>,
    faults: VecDeque<String>,
    /// Rows that stand on the terminal.
    rows: usize,
}

impl Screen {
    /// Remembers a fault for the next screen.
    pub(super) fn fault(&mut self, fault: &DeviceFault) {
        if self.faults.len() == FAULTS {
            self.faults.pop_front();
        }
        self.faults.push_back(fault.to_string());
    }

    /// The next screen, with the codes that put it over the last one.
    pub(super) fn draw(&mut self, line: &Line) -> String {
        self.pressures_pa.resize_with(line.pressures_pa.len(), VecDeque::new);
        let mut text = if self.rows == 0 { String::new() } else { format!("{UP}{}A{CLEAR}", self.rows) };
        let head = text.len();
        let (time_s, supply) = (line.time_s, line.supply_pa * 1e-3);
        let valves = line.valves();
        let _ = writeln!(text, "{time_s:10.3} s  {}  supply {supply:.1} kPa{valves}", line.state);
        for (channel, memory) in self.pressures_pa.iter_mut().enumerate() {
            if memory.len() == MEMORY {
                memory.pop_front();
            }
            memory.push_back(line.pressures_pa[channel]);
            let [pressure, reference] = [line.pressures_pa[channel], line.references_pa[channel]].map(|pa| pa * 1e-3);
            let duty = 100.0 * line.duties[channel];
            let _ =
                writeln!(text, "{channel:3}  {pressure:7.2} of {reference:7.2} kPa  {duty:+4.0} %  {}", bars(memory));
        }
        for fault in line.faults.iter().map(|fault| format!("latched: {fault}")).chain(self.faults.iter().cloned()) {
            let _ = writeln!(text, "     {fault}");
        }
        self.rows = text[head..].lines().count();
        text
    }
}

/// Pressures as bars, from zero to the highest of them.
fn bars(pressures_pa: &VecDeque<f64>) -> String {
    let full_pa = pressures_pa.iter().copied().fold(FULL_MIN_PA, f64::max);
    let bar = |pressure_pa: &f64| BARS[((pressure_pa / full_pa * 8.0) as usize).min(BARS.len() - 1)];
    pressures_pa.iter().map(bar).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(pressure_pa: f64, faults: &[&str]) -> Line {
        Line {
            time_s: 1.5,
            state: "Running".to_owned(),
            supply_pa: 200e3,
            valve_supply_v: Some(23.96),
            pressures_pa: vec![pressure_pa, 0.0],
            references_pa: vec![40e3, 0.0],
            duties: vec![0.25, -1.0],
            faults: faults.iter().map(|&fault| fault.to_owned()).collect(),
        }
    }

    #[test]
    fn bars_rise_from_zero_to_the_highest() {
        let of = |pressures: &[f64]| bars(&pressures.iter().copied().collect());
        assert_eq!(of(&[0.0, 20e3, 40e3, 80e3]), "▁▃▅█");
        assert_eq!(of(&[0.0, 10.0]), "▁▁", "noise at rest");
    }

    #[test]
    fn screen_is_drawn_over_the_last_one() {
        let mut screen = Screen::default();
        let first = screen.draw(&line(20e3, &[]));
        assert!(!first.contains('\u{1b}') && first.lines().count() == 3, "{first:?}");
        assert!(first.contains("20.00 of   40.00 kPa   +25 %"), "{first}");
        assert!(first.contains("supply 200.0 kPa  valves 24.0 V\n"), "{first}");
        let second = screen.draw(&line(40e3, &["link lost"]));
        assert!(second.starts_with("\u{1b}[3A\u{1b}[J"), "{second:?}");
        assert!(second.contains("latched: link lost"), "{second}");
        assert!(screen.draw(&line(40e3, &[])).starts_with("\u{1b}[4A\u{1b}[J"));
    }
}

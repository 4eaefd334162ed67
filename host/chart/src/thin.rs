//! Fewer points, same picture: a log has thousands of samples, a chart some hundreds
//! of pixels.

/// Points closer than this to the line through their neighbours are not missed, px.
const TOLERANCE_PX: f64 = 0.08;
/// Points closer than this to each other are one to the eye, px.
const CROWD_PX: f64 = 0.2;

/// Polylines that draw as the given one, in px. Points that are not finite part it.
///
/// Of a line that runs from left to right, only the first, the lowest, the highest and
/// the last point in each pixel column stay, so no peak is lost; of any other line, the
/// points that crowd. Then points on a straight line go.
pub(super) fn thin(points: impl IntoIterator<Item = [f64; 2]>) -> Vec<Vec<[f64; 2]>> {
    let mut pieces = vec![Vec::new()];
    for point in points {
        match (point.iter().all(|value| value.is_finite()), pieces.last_mut()) {
            (true, Some(piece)) => piece.push(point),
            _ => pieces.push(Vec::new()),
        }
    }
    pieces.retain(|piece| !piece.is_empty());
    pieces.into_iter().map(|piece| straightened(&sparse(&piece))).collect()
}

fn sparse(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    match points.is_sorted_by(|a, b| a[0] <= b[0]) {
        true => by_column(points),
        false => apart(points),
    }
}

/// Drops points that crowd around the last kept one, except the end.
fn apart(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut kept: Vec<[f64; 2]> = Vec::new();
    for (index, &point) in points.iter().enumerate() {
        let far = kept.last().is_none_or(|last| (point[0] - last[0]).hypot(point[1] - last[1]) >= CROWD_PX);
        if far || index + 1 == points.len() {
            kept.push(point);
        }
    }
    kept
}

fn by_column(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut kept = Vec::new();
    for column in points.chunk_by(|a, b| a[0].floor() == b[0].floor()) {
        let by_height = |a: &usize, b: &usize| column[*a][1].total_cmp(&column[*b][1]);
        let lowest = (0..column.len()).min_by(by_height).unwrap_or(0);
        let highest = (0..column.len()).max_by(by_height).unwrap_or(0);
        let mut stay = [0, lowest, highest, column.len() - 1];
        stay.sort_unstable();
        let mut last = None;
        for index in stay {
            if last.replace(index) != Some(index) {
                kept.push(column[index]);
            }
        }
    }
    kept
}

/// Drops the points that are within the tolerance of the line that remains (Ramer,
/// Douglas and Peucker, with a list of stretches in place of recursion).
fn straightened(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut stays = vec![true; points.len()];
    let mut stretches = vec![(0, points.len().saturating_sub(1))];
    while let Some((first, last)) = stretches.pop() {
        let inner = first + 1..last.max(first + 1);
        let off = |index: &usize| distance_to(points[*index], points[first], points[last]);
        let Some(farthest) = inner.clone().max_by(|a, b| off(a).total_cmp(&off(b))) else { continue };
        if off(&farthest) > TOLERANCE_PX {
            stretches.extend([(first, farthest), (farthest, last)]);
        } else {
            stays[inner].fill(false);
        }
    }
    points.iter().zip(stays).filter_map(|(&point, stays)| stays.then_some(point)).collect()
}

/// Distance of a point from the stretch between two others.
fn distance_to(point: [f64; 2], from: [f64; 2], to: [f64; 2]) -> f64 {
    let along = [to[0] - from[0], to[1] - from[1]];
    let offset = [point[0] - from[0], point[1] - from[1]];
    let square = along[0] * along[0] + along[1] * along[1];
    let share = if square > 0.0 { (along[0] * offset[0] + along[1] * offset[1]) / square } else { 0.0 };
    let share = share.clamp(0.0, 1.0);
    (offset[0] - share * along[0]).hypot(offset[1] - share * along[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn straight_line_is_its_ends() {
        let line = (0..1000).map(|i| [f64::from(i) * 0.5, 100.0 - f64::from(i) * 0.1]);
        assert_eq!(thin(line), [vec![[0.0, 100.0], [499.5, 100.0 - 99.9]]]);
    }

    #[test]
    fn peaks_are_kept() {
        let mut noisy: Vec<_> = (0..60_000).map(|i| [f64::from(i) * 0.01, 50.0]).collect();
        noisy[12_345][1] = 3.0;
        noisy[40_000][1] = 97.0;
        let [line] = &thin(noisy)[..] else { panic!("one piece") };
        assert!(line.contains(&[123.45, 3.0]) && line.contains(&[400.0, 97.0]));
        assert!(line.len() < 20, "{} points", line.len());
    }

    #[test]
    fn noise_is_bounded_by_the_pixels() {
        let noise = (0..60_000).map(|i| [f64::from(i) * 0.01, f64::from(i * 7919 % 101)]);
        assert!(thin(noise)[0].len() <= 4 * 601);
    }

    #[test]
    fn line_that_turns_back_keeps_its_turn() {
        let back = [[0.0, 0.0], [10.0, 0.0], [4.0, 0.0]];
        assert_eq!(thin(back), [back.to_vec()]);
    }

    #[test]
    fn circle_stays_round() {
        let circle = (0..=2000).map(|i| {
            let angle = f64::from(i) * std::f64::consts::TAU / 2000.0;
            [100.0 * angle.cos(), 100.0 * angle.sin()]
        });
        let line = &thin(circle)[0];
        assert!(line.len() < 500, "{} points", line.len());
        for ends in line.windows(2) {
            let middle = [0, 1].map(|axis| (ends[0][axis] + ends[1][axis]) / 2.0);
            assert!(100.0 - middle[0].hypot(middle[1]) <= TOLERANCE_PX * 1.01);
        }
    }

    #[test]
    fn missing_values_are_gaps() {
        let points = [[f64::NAN, 0.0], [0.0, 0.0], [9.0, 9.0], [5.0, f64::INFINITY], [20.0, 1.0]];
        assert_eq!(thin(points), [vec![[0.0, 0.0], [9.0, 9.0]], vec![[20.0, 1.0]]]);
        assert_eq!(thin([]), Vec::<Vec<[f64; 2]>>::new());
    }
}

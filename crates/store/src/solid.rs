//! A turned part for other programs: STL of the whole, DXF of a cross-section.
//!
//! ```text
//!   slices, each a radius per equal angle ─► side walls between neighbours, a fan at each end ─► binary STL, mm
//!   outline ─► closed polyline of R12, which every reader of DXF knows
//! ```
use std::f64::consts::TAU;
use units::Length;

/// A cross-section of a part that turns about Z.
#[derive(Clone, Debug, PartialEq)]
pub struct Slice {
    /// Where.
    pub z: Length,
    /// Radius at equal angles from X on, counter-clockwise; as many in every slice.
    pub radii: Vec<Length>,
}

/// The radii at `count` equal angles of an outline around the axis; `None` of fewer than three
/// points.
pub fn radii(outline: &[[Length; 2]], count: usize) -> Option<Vec<Length>> {
    if outline.len() < 3 {
        return None;
    }
    let mut polar: Vec<(f64, f64)> = outline
        .iter()
        .map(|[x, y]| (x.value(), y.value()))
        .map(|(x, y)| (y.atan2(x).rem_euclid(TAU), x.hypot(y)))
        .collect();
    polar.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (first, last) = (polar[0], polar[polar.len() - 1]);
    polar.insert(0, (last.0 - TAU, last.1));
    polar.push((first.0 + TAU, first.1));
    let at = |i: usize| {
        let angle = TAU * i as f64 / count as f64;
        let after = polar.partition_point(|p| p.0 < angle).clamp(1, polar.len() - 1);
        Length::mm(chord(polar[after - 1], polar[after], angle))
    };
    Some((0..count).map(at).collect())
}

/// Where the straight line between two points (angle, radius) crosses a ray.
fn chord(a: (f64, f64), b: (f64, f64), angle: f64) -> f64 {
    // the triangle of the centre and both points is the sum of the two on either side of the ray
    let sides = a.1 * (angle - a.0).sin() + b.1 * (b.0 - angle).sin();
    if sides > 0.0 && b.0 > a.0 { a.1 * b.1 * (b.0 - a.0).sin() / sides } else { a.1 }
}

/// Binary STL of a part; empty without two slices of three radii.
pub fn stl(slices: &[Slice]) -> Vec<u8> {
    let count = slices.first().map_or(0, |s| s.radii.len());
    if slices.len() < 2 || count < 3 || slices.iter().any(|s| s.radii.len() != count) {
        return Vec::new();
    }
    let mut rising: Vec<&Slice> = slices.iter().collect();
    rising.sort_by(|a, b| a.z.value().total_cmp(&b.z.value()));
    let point = |slice: &Slice, i: usize| {
        let (sine, cosine) = (TAU * (i % count) as f64 / count as f64).sin_cos();
        let r = slice.radii[i % count].value();
        [r * cosine, r * sine, slice.z.value()]
    };
    let mut triangles = Vec::new();
    for pair in rising.windows(2) {
        for i in 0..count {
            let (a, b) = (point(pair[0], i), point(pair[0], i + 1));
            let (c, d) = (point(pair[1], i), point(pair[1], i + 1));
            triangles.push([a, b, d]);
            triangles.push([a, d, c]);
        }
    }
    let (low, high) = (rising[0], rising[rising.len() - 1]);
    for i in 0..count {
        triangles.push([[0.0, 0.0, low.z.value()], point(low, i + 1), point(low, i)]);
        triangles.push([[0.0, 0.0, high.z.value()], point(high, i), point(high, i + 1)]);
    }
    let mut file = vec![0; 80];
    file[..9].copy_from_slice(b"leadscrew");
    file.extend((triangles.len() as u32).to_le_bytes());
    for triangle in triangles {
        for vector in std::iter::once(normal(&triangle)).chain(triangle) {
            file.extend(vector.iter().flat_map(|v| (*v as f32).to_le_bytes()));
        }
        file.extend([0, 0]);
    }
    file
}

fn normal([a, b, c]: &[[f64; 3]; 3]) -> [f64; 3] {
    let minus = |p: &[f64; 3]| [p[0] - a[0], p[1] - a[1], p[2] - a[2]];
    let (u, v) = (minus(b), minus(c));
    let n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    let size = n.iter().map(|x| x * x).sum::<f64>().sqrt();
    if size > 0.0 { n.map(|x| x / size) } else { [0.0; 3] }
}

/// DXF (R12) of a closed outline, mm.
pub fn dxf(outline: &[[Length; 2]]) -> String {
    let mut text = "0\nSECTION\n2\nENTITIES\n0\nPOLYLINE\n8\n0\n66\n1\n70\n1\n".to_owned();
    for [x, y] in outline {
        text += &format!("0\nVERTEX\n8\n0\n10\n{:.6}\n20\n{:.6}\n", x.value(), y.value());
    }
    text + "0\nSEQEND\n8\n0\n0\nENDSEC\n0\nEOF\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> Vec<[Length; 2]> {
        [[1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0]].map(|p| p.map(Length::mm)).to_vec()
    }

    #[test]
    fn an_stl_encloses_the_volume_of_its_slices() {
        let slice = |z| Slice { z: Length::mm(z), radii: radii(&square(), 720).unwrap() };
        let file = stl(&[slice(0.0), slice(-5.0)]);
        let count = u32::from_le_bytes(file[80..84].try_into().unwrap()) as usize;
        assert_eq!(file.len(), 84 + 50 * count);
        // divergence theorem over the triangles
        let number =
            |at: usize| f64::from(f32::from_le_bytes(file[at..at + 4].try_into().unwrap()));
        let volume: f64 = (0..count)
            .map(|t| {
                let v = |k: usize| [0, 1, 2].map(|i| number(84 + 50 * t + 12 * (k + 1) + 4 * i));
                let (a, b, c) = (v(0), v(1), v(2));
                (a[0] * (b[1] * c[2] - b[2] * c[1])
                    + a[1] * (b[2] * c[0] - b[0] * c[2])
                    + a[2] * (b[0] * c[1] - b[1] * c[0]))
                    / 6.0
            })
            .sum();
        assert!((volume - 20.0).abs() < 0.001, "{volume}");
    }

    #[test]
    fn a_dxf_has_a_vertex_for_each_point_and_is_closed() {
        let text = dxf(&square());
        assert_eq!(text.matches("VERTEX").count(), 4);
        assert!(text.contains("\n70\n1\n") && text.ends_with("EOF\n"));
    }
}

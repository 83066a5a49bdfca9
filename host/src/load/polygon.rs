//! Polygons to triangles by ear clipping.
//!
//! An ear is a corner whose triangle with its two neighbours lies inside the polygon (Meisters, 1975). All edges of the
//! polygon, also those between corners on one line, become edges of triangles, so that neighbouring faces still
//! meet without gaps. A convex polygon becomes the fan from its first corner.

/// What was found about a polygon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Outline {
    /// It does not cross itself, or has no area at all.
    Simple,
    /// It crosses itself: its triangles are the fan from its first corner.
    Crossing,
}

/// Memory for [`Triangulator::triangulate`], used again for each polygon.
#[derive(Debug, Default)]
pub(super) struct Triangulator {
    /// The polygon in its plane, counter-clockwise.
    points: Vec<[f64; 2]>,
    /// Corners that are left, in order.
    ring: Vec<usize>,
    /// For each corner whether it was an ear when last looked at.
    ears: Vec<bool>,
}

impl Triangulator {
    /// Appends the triangles of the polygon with these `corners`, as numbers of corners, wound as the polygon; at most
    /// `corners.len() - 2`. Any input ends; coordinates must be finite for a sensible answer.
    pub(super) fn triangulate(&mut self, corners: &[[f32; 3]], triangles: &mut Vec<[usize; 3]>) -> Outline {
        self.ring.clear();
        self.ring.extend(0..corners.len());
        self.ring.dedup_by_key(|corner| corners[*corner]);
        while self.ring.len() > 1 && corners[self.ring[0]] == corners[self.ring[self.ring.len() - 1]] {
            self.ring.pop();
        }
        if self.ring.len() < 3 {
            return Outline::Simple;
        }
        let start = triangles.len();
        let simple = match self.project(corners) {
            Plane::None => return Outline::Simple,
            Plane::Undecided => false,
            Plane::Found => !self.crosses_itself() && self.clip_ears(triangles),
        };
        if simple {
            return Outline::Simple;
        }
        triangles.truncate(start);
        triangles.extend((2..corners.len()).map(|corner| [0, corner - 1, corner]));
        Outline::Crossing
    }

    /// Drops the axis in which the polygon's normal (Newell's: the sum over its edges, here around its first corner so
    /// that a far origin costs no digits) is longest.
    fn project(&mut self, corners: &[[f32; 3]]) -> Plane {
        let origin = corners[self.ring[0]].map(f64::from);
        let from_origin = |corner: usize| {
            let corner = corners[corner].map(f64::from);
            [corner[0] - origin[0], corner[1] - origin[1], corner[2] - origin[2]]
        };
        let mut normal = [0.0; 3];
        let mut flat = true;
        for pair in self.ring[1..].windows(2) {
            let (a, b) = (from_origin(pair[0]), from_origin(pair[1]));
            let cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
            for axis in 0..3 {
                normal[axis] += cross[axis];
                flat &= cross[axis] == 0.0;
            }
        }
        if flat {
            return Plane::None;
        }
        let longest = (1..3).fold(0, |best, axis| if normal[axis].abs() > normal[best].abs() { axis } else { best });
        let (mut first, mut second) = ((longest + 1) % 3, (longest + 2) % 3);
        if normal[longest] < 0.0 {
            std::mem::swap(&mut first, &mut second);
        }
        self.points.clear();
        self.points.extend(corners.iter().map(|corner| [f64::from(corner[first]), f64::from(corner[second])]));
        if normal == [0.0; 3] { Plane::Undecided } else { Plane::Found }
    }

    /// Whether two edges cross at a point inside both. Edges that only touch, as those that lead to a hole, do not.
    fn crosses_itself(&self) -> bool {
        let count = self.ring.len();
        let edge = |index: usize| (self.points[self.ring[index]], self.points[self.ring[(index + 1) % count]]);
        (0..count).any(|i| {
            let (a, b) = edge(i);
            (i + 2..count).any(|j| {
                let (c, d) = edge(j);
                let apart = a[0].max(b[0]) < c[0].min(d[0]) || c[0].max(d[0]) < a[0].min(b[0]);
                !apart && opposite(side(a, b, c), side(a, b, d)) && opposite(side(c, d, a), side(c, d, b))
            })
        })
    }

    /// Clips until nothing is left; `false` where no ear can be found, which a polygon that does not cross itself
    /// always has.
    fn clip_ears(&mut self, triangles: &mut Vec<[usize; 3]>) -> bool {
        self.ears.clear();
        self.ears.resize(self.points.len(), false);
        self.find_all_ears();
        let mut at = 1;
        while self.ring.len() > 2 {
            let count = self.ring.len();
            if let Some(ear) = (0..count).map(|step| (at + step) % count).find(|&index| self.ears[self.ring[index]]) {
                let [before, tip, after] = self.around(ear);
                triangles.push([before, tip, after]);
                at = self.remove(ear);
                continue;
            }
            // Corners without area (spikes, doubled edges) can hide an ear from the two looks at its neighbours.
            if self.find_all_ears() {
                continue;
            }
            let flat = |&index: &usize| {
                let [before, tip, after] = self.around(index).map(|corner| self.points[corner]);
                side(before, tip, after) == 0.0
            };
            let Some(index) = (0..count).find(flat) else { return false };
            at = self.remove(index);
        }
        true
    }

    /// The corner at `index` of the ring between its neighbours.
    fn around(&self, index: usize) -> [usize; 3] {
        let count = self.ring.len();
        [self.ring[(index + count - 1) % count], self.ring[index], self.ring[(index + 1) % count]]
    }

    /// Takes a corner out of the ring, looks at its neighbours again, and gives the place of the one after it.
    fn remove(&mut self, index: usize) -> usize {
        self.ring.remove(index);
        let count = self.ring.len();
        let (before, after) = ((index + count - 1) % count, index % count);
        for neighbour in [before, after] {
            self.ears[self.ring[neighbour]] = self.is_ear(neighbour);
        }
        after
    }

    fn find_all_ears(&mut self) -> bool {
        let mut any = false;
        for index in 0..self.ring.len() {
            let ear = self.is_ear(index);
            self.ears[self.ring[index]] = ear;
            any |= ear;
        }
        any
    }

    /// Whether the corner is convex and no other corner lies in its triangle or on the triangle's border. A corner
    /// at the same point as one of the three does not count: polygons with holes pass such points twice.
    fn is_ear(&self, index: usize) -> bool {
        let [a, b, c] = self.around(index).map(|corner| self.points[corner]);
        side(a, b, c) > 0.0
            && self.ring.iter().map(|&corner| self.points[corner]).all(|p| {
                side(a, b, p) < 0.0 || side(b, c, p) < 0.0 || side(c, a, p) < 0.0 || p == a || p == b || p == c
            })
    }
}

enum Plane {
    /// All corners lie on one line.
    None,
    /// Parts of the polygon cancel each other: it crosses itself.
    Undecided,
    /// The polygon is projected.
    Found,
}

/// Twice the area of the triangle, positive if counter-clockwise. The inputs are single precision numbers, so in double
/// precision the sign is exact while differences span less than 26 bits, and else wrong only within 2^-51 of flat.
fn side(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

fn opposite(a: f64, b: f64) -> bool {
    (a > 0.0 && b < 0.0) || (a < 0.0 && b > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangulate(corners: &[[f32; 3]]) -> (Vec<[usize; 3]>, Outline) {
        let mut triangles = vec![[9, 9, 9]];
        let outline = Triangulator::default().triangulate(corners, &mut triangles);
        assert_eq!(triangles.remove(0), [9, 9, 9], "only appends");
        assert!(triangles.len() + 2 <= corners.len().max(2));
        (triangles, outline)
    }

    fn flat(points: &[[f64; 2]]) -> Vec<[f32; 3]> {
        points.iter().map(|p| [p[0] as f32, p[1] as f32, 0.0]).collect()
    }

    fn area(points: &[[f64; 2]]) -> f64 {
        (1..points.len() - 1).map(|i| 0.5 * side(points[0], points[i], points[i + 1])).sum()
    }

    /// Even-odd rule, for points that are on no edge.
    fn inside(points: &[[f64; 2]], p: [f64; 2]) -> bool {
        let edges = points.iter().zip(points.iter().cycle().skip(1));
        edges
            .filter(|(a, b)| {
                (a[1] > p[1]) != (b[1] > p[1]) && p[0] < a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
            })
            .count()
            % 2
            == 1
    }

    /// All n-2 triangles have area, are wound as the polygon, lie inside, and together have its area.
    fn check_simple(points: &[[f64; 2]]) {
        let mut turned: Vec<_> = points.to_vec();
        for start in 0..points.len() {
            for (axis, reversed) in [(0, false), (1, false), (2, false), (2, true)] {
                let mut points = turned.clone();
                if reversed {
                    points.reverse();
                }
                let corners: Vec<_> = flat(&points)
                    .into_iter()
                    .map(|mut corner| {
                        corner[2] = 3.0;
                        corner.rotate_right((axis + 1) % 3);
                        corner
                    })
                    .collect();
                let (triangles, outline) = triangulate(&corners);
                assert_eq!(outline, Outline::Simple);
                assert_eq!(triangles.len(), points.len() - 2, "start {start}");
                let sign = if reversed { -1.0 } else { 1.0 };
                let mut sum = 0.0;
                for triangle in triangles {
                    let [a, b, c] = triangle.map(|corner| points[corner]);
                    let area = 0.5 * sign * side(a, b, c);
                    assert!(area > 0.0, "{triangle:?} from {start}");
                    sum += area;
                    let centroid = [(a[0] + b[0] + c[0]) / 3.0, (a[1] + b[1] + c[1]) / 3.0];
                    assert!(inside(&points, centroid), "{triangle:?} from {start}");
                }
                assert!((sum - sign * area(&points)).abs() < 1e-5 * sum, "{sum} from {start}");
            }
            turned.rotate_left(1);
        }
    }

    fn circle(index: usize, count: usize, radius: f64) -> [f64; 2] {
        let angle = index as f64 / count as f64 * std::f64::consts::TAU;
        let round = |x: f64| f64::from(x as f32);
        [round(radius * libm::cos(angle)), round(radius * libm::sin(angle))]
    }

    #[test]
    fn convex_polygons_become_the_fan_of_their_first_corner() {
        let hexagon: Vec<_> = (0..6).map(|i| circle(i, 6, 1.0)).collect();
        assert_eq!(triangulate(&flat(&hexagon)).0, [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]]);
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        assert_eq!(triangulate(&flat(&square)).0, [[0, 1, 2], [0, 2, 3]]);
        check_simple(&hexagon);
    }

    #[test]
    fn concave_polygons_keep_their_area_and_stay_inside() {
        let l = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
        check_simple(&l);
        let dart = [[0.0, 0.0], [2.0, 1.0], [0.0, 2.0], [0.5, 1.0]];
        check_simple(&dart);
        let star: Vec<_> = (0..14).map(|i| circle(i, 14, if i % 2 == 0 { 1.0 } else { 0.2 })).collect();
        check_simple(&star);
        let comb: Vec<_> =
            (0..9).map(|i| [f64::from(i), f64::from(i % 2 * 5)]).chain([[8.0, -1.0], [0.0, -1.0]]).collect();
        check_simple(&comb.into_iter().rev().collect::<Vec<_>>());
    }

    #[test]
    fn a_spiral_keeps_its_area() {
        let arm = |offset: f64| (0..40).map(move |i| circle(i, 12, 1.0 + 0.1 * f64::from(i as u32) + offset));
        let outer: Vec<_> = arm(0.5).collect();
        let spiral: Vec<_> = outer.into_iter().chain(arm(0.0).collect::<Vec<_>>().into_iter().rev()).collect();
        check_simple(&spiral);
    }

    #[test]
    fn corners_on_an_edge_stay_corners_of_triangles() {
        let square = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 1.0], [2.0, 2.0], [1.0, 2.0], [0.0, 2.0], [0.0, 1.0]];
        check_simple(&square);
        check_simple(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [0.0, 2.0]]);
    }

    #[test]
    fn a_hole_that_a_doubled_edge_leads_to_stays_open() {
        let outer = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0], [0.0, 0.0]];
        let hole = [[1.0, 1.0], [1.0, 3.0], [3.0, 3.0], [3.0, 1.0], [1.0, 1.0]];
        let points: Vec<_> = outer.into_iter().chain(hole).collect();
        let (triangles, outline) = triangulate(&flat(&points));
        assert_eq!((triangles.len(), outline), (points.len() - 2, Outline::Simple));
        let mut sum = 0.0;
        for triangle in triangles {
            let [a, b, c] = triangle.map(|corner| points[corner]);
            sum += 0.5 * side(a, b, c);
            let centroid = [(a[0] + b[0] + c[0]) / 3.0, (a[1] + b[1] + c[1]) / 3.0];
            assert!(!(centroid[0] > 1.0 && centroid[0] < 3.0 && centroid[1] > 1.0 && centroid[1] < 3.0));
        }
        assert_eq!(sum, 12.0);
    }

    #[test]
    fn repeated_corners_and_spikes_lose_no_area() {
        let doubled = [[0.0, 0.0], [0.0, 0.0], [2.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0], [0.0, 0.0]];
        let (triangles, outline) = triangulate(&flat(&doubled));
        assert_eq!((triangles.len(), outline), (2, Outline::Simple));
        let spike = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [3.0, 3.0], [2.0, 2.0], [0.0, 2.0]];
        let (triangles, outline) = triangulate(&flat(&spike));
        assert_eq!(outline, Outline::Simple);
        let sum: f64 = triangles.iter().map(|t| 0.5 * side(spike[t[0]], spike[t[1]], spike[t[2]])).sum();
        assert_eq!(sum, 4.0);
    }

    #[test]
    fn polygons_without_area_give_nothing() {
        for points in
            [&[[0.0, 0.0]; 5][..], &[[0.0, 0.0], [1.0, 1.0], [2.0, 2.0], [3.0, 3.0]], &[[0.0, 0.0], [1.0, 0.0]], &[]]
        {
            assert_eq!(triangulate(&flat(points)), (vec![], Outline::Simple), "{points:?}");
        }
    }

    #[test]
    fn polygons_that_cross_themselves_are_fanned() {
        let fan = |count: usize| (2..count).map(|i| [0, i - 1, i]).collect::<Vec<_>>();
        let bow_tie = [[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 2.0]];
        assert_eq!(triangulate(&flat(&bow_tie)), (fan(4), Outline::Crossing));
        let uneven = [[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 3.0]];
        assert_eq!(triangulate(&flat(&uneven)), (fan(4), Outline::Crossing));
        let pentagram: Vec<_> = (0..5).map(|i| circle(2 * i, 5, 1.0)).collect();
        assert_eq!(triangulate(&flat(&pentagram)), (fan(5), Outline::Crossing));
    }

    #[test]
    fn far_from_the_origin_the_plane_is_still_found() {
        let l = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
        let corners: Vec<_> = l.map(|p| [p[0] as f32 + 65536.0, 1e6, p[1] as f32 - 65536.0]).to_vec();
        let (triangles, outline) = triangulate(&corners);
        assert_eq!((triangles.len(), outline), (4, Outline::Simple));
        let sum: f64 = triangles.iter().map(|t| 0.5 * side(l[t[0]], l[t[1]], l[t[2]])).sum();
        assert_eq!(sum, 3.0);
    }

    #[test]
    fn any_corners_come_to_an_end() {
        let mut state = 1_u32;
        let mut next = |range: u32| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 16) % range
        };
        for _ in 0..5000 {
            let count = next(12) as usize;
            let corners: Vec<_> = (0..count).map(|_| [next(4) as f32, next(4) as f32, next(2) as f32]).collect();
            triangulate(&corners);
        }
        triangulate(&[[f32::NAN; 3]; 6]);
        triangulate(&[[f32::MAX, 0.0, 0.0], [0.0, f32::MAX, 0.0], [f32::MIN, 0.0, 0.0], [0.0, f32::INFINITY, 1.0]]);
    }
}

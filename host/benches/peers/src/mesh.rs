//! The meshes: one that is read, and closed ones of any size that are made.

use std::path::Path;

/// Triangles over shared corners.
pub(crate) struct Mesh {
    /// What the tables call it.
    pub(crate) name: String,
    /// Corners.
    pub(crate) positions: Vec<[f32; 3]>,
    /// Indices of corners, counter-clockwise seen from outside.
    pub(crate) triangles: Vec<[u32; 3]>,
    /// Whether it surely has no holes, so that every ray from around its middle must hit it.
    pub(crate) closed: bool,
}

/// Octaves of the bumps: the last has some forty triangles per bump in a mesh of two million.
const OCTAVES: u32 = 7;
/// Height of the largest bumps; the radius is 1.
const HEIGHT: f64 = 0.35;
/// How much lower the bumps of the next octave are. They are half as wide, so the surface gets a little smoother.
const GAIN: f64 = 0.45;

impl Mesh {
    /// Reads the triangles of an OBJ file.
    pub(crate) fn load(path: &Path) -> Result<Self, String> {
        let options = tobj::LoadOptions { triangulate: true, ..Default::default() };
        let (models, _) = tobj::load_obj(path, &options).map_err(|error| format!("{}: {error}", path.display()))?;
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let mut mesh = Self { name, positions: Vec::new(), triangles: Vec::new(), closed: false };
        for model in models {
            let first = mesh.positions.len() as u32;
            mesh.positions.extend(model.mesh.positions.as_chunks().0);
            let triangles = model.mesh.indices.as_chunks::<3>().0;
            mesh.triangles.extend(triangles.iter().map(|corners| corners.map(|corner| corner + first)));
        }
        Ok(mesh)
    }

    /// A sphere with bumps upon bumps, as a scan has them, of at least so many triangles.
    pub(crate) fn bumpy(triangles: usize) -> Self {
        Self::from_octahedron("bumps", triangles, |direction| {
            let (mut frequency, mut height, mut radius) = (1.5, HEIGHT, 1.0);
            for octave in 0..OCTAVES {
                radius += height * noise(direction.map(|x| x * frequency), octave);
                frequency *= 2.0;
                height *= GAIN;
            }
            radius
        })
    }

    /// A plain sphere of at least so many triangles.
    pub(crate) fn sphere(triangles: usize) -> Self {
        Self::from_octahedron("sphere", triangles, |_| 1.0)
    }

    /// An octahedron whose faces are cut into grids, each corner pushed out to the `radius` of its direction. A
    /// positive radius makes it closed and visible from the middle.
    fn from_octahedron(name: &str, triangles: usize, radius: impl Fn([f64; 3]) -> f64) -> Self {
        let mut cuts = 1i32;
        while 8 * (cuts as usize).pow(2) < triangles {
            cuts += 1;
        }
        // Grid points of the surface |x| + |y| + |z| = cuts are known by x, y and the sign of z.
        let side = 2 * cuts as usize + 1;
        let mut numbers = vec![u32::MAX; 2 * side * side];
        let mut positions = Vec::new();
        let mut corner = |point: [i32; 3]| {
            let cell = (point[0] + cuts) as usize * side + (point[1] + cuts) as usize;
            let number = &mut numbers[2 * cell + usize::from(point[2] < 0)];
            if *number == u32::MAX {
                *number = positions.len() as u32;
                let direction = unit(point.map(f64::from));
                let radius = radius(direction);
                positions.push(direction.map(|x| (x * radius) as f32));
            }
            *number
        };
        let mut triangles = Vec::new();
        for octant in 0..8 {
            let signs = [0, 1, 2].map(|axis| if octant >> axis & 1 == 0 { 1 } else { -1 });
            let mirrored = signs[0] * signs[1] * signs[2] < 0;
            let mut add = |points: [[i32; 2]; 3]| {
                let [a, b, c] = points.map(|[x, y]| corner([signs[0] * x, signs[1] * y, signs[2] * (cuts - x - y)]));
                triangles.push(if mirrored { [a, c, b] } else { [a, b, c] });
            };
            for x in 0..cuts {
                for y in 0..cuts - x {
                    add([[x, y], [x + 1, y], [x, y + 1]]);
                    if x + y + 1 < cuts {
                        add([[x + 1, y], [x + 1, y + 1], [x, y + 1]]);
                    }
                }
            }
        }
        Self { name: name.to_owned(), positions, triangles, closed: true }
    }

    /// The corners of a triangle.
    pub(crate) fn corners(&self, triangle: u32) -> [[f64; 3]; 3] {
        self.triangles[triangle as usize].map(|corner| self.positions[corner as usize].map(f64::from))
    }

    /// The middle of its box, and the largest distance of a corner from there.
    pub(crate) fn bounding_sphere(&self) -> ([f64; 3], f64) {
        let extreme = |axis: usize, pick: fn(f32, f32) -> f32| {
            f64::from(self.positions.iter().map(|position| position[axis]).reduce(pick).unwrap_or(0.0))
        };
        let center = [0, 1, 2].map(|axis| 0.5 * (extreme(axis, f32::min) + extreme(axis, f32::max)));
        let square = |position: &[f32; 3]| {
            let offset = sub(position.map(f64::from), center);
            dot(offset, offset)
        };
        (center, self.positions.iter().map(square).fold(0.0, f64::max).sqrt())
    }

    /// Bytes of the corners and indices.
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(self.positions.as_slice()) + size_of_val(self.triangles.as_slice())
    }
}

/// Smooth noise in -1..1, about one bump per unit.
fn noise(point: [f64; 3], octave: u32) -> f64 {
    let cell = point.map(f64::floor);
    let fraction = [0, 1, 2].map(|axis| point[axis] - cell[axis]);
    // The first and second derivatives are zero at both ends.
    let ease = fraction.map(|x| x * x * x * (x * (x * 6.0 - 15.0) + 10.0));
    (0..8).fold(0.0, |sum, corner| {
        let far = [0, 1, 2].map(|axis| corner >> axis & 1);
        let weight =
            (0..3).fold(1.0, |weight, axis| weight * if far[axis] == 1 { ease[axis] } else { 1.0 - ease[axis] });
        let lattice = [0, 1, 2].map(|axis| (cell[axis] as i64 + far[axis] as i64) as u64);
        sum + weight * (uniform(hash(lattice, octave)) * 2.0 - 1.0)
    })
}

fn hash(lattice: [u64; 3], octave: u32) -> u64 {
    lattice.iter().fold(u64::from(octave), |state, &x| mix(state.wrapping_mul(31).wrapping_add(x)))
}

/// A permutation of 64 bits that leaves no pattern (the finaliser of SplitMix64).
pub(crate) fn mix(mut x: u64) -> u64 {
    x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    x = (x ^ x >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ x >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ x >> 31
}

/// The upper bits as a number in 0..1.
pub(crate) fn uniform(bits: u64) -> f64 {
    (bits >> 11) as f64 / (1u64 << 53) as f64
}

/// `a - b`.
pub(crate) fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// `a + b t`.
pub(crate) fn along(a: [f64; 3], b: [f64; 3], t: f64) -> [f64; 3] {
    [a[0] + b[0] * t, a[1] + b[1] * t, a[2] + b[2] * t]
}

/// The scalar product.
pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The vector product.
pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The same direction with length 1.
pub(crate) fn unit(a: [f64; 3]) -> [f64; 3] {
    let length = dot(a, a).sqrt();
    a.map(|x| x / length)
}

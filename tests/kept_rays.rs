//! N15. Rays and triangles kept bit by bit, which some intersection test got wrong or could: every bug that is found
//! adds a row. What is right is not written down on trust but found in exact arithmetic.

use ocellus_kernel::Ray;
use ocellus_kernel::real::{Real, Vec3};

use crate::support::exact::{ExactVec, exact};
use crate::support::in_both_precisions;
use crate::support::meshes::Mesh;
use crate::support::scene::{STRUCTURES, one_material, v};
use crate::support::trials::Trials;

in_both_precisions!(kept_rays_hit_and_miss_as_they_should);

/// A ray (origin and direction) at some triangles, as bits of f32 or f64. Rows of f32 hold in f64, too.
struct Row<Bits: 'static> {
    what: &'static str,
    hit: bool,
    ray: [[Bits; 3]; 2],
    triangles: &'static [[[Bits; 3]; 3]],
}

const SINGLE: &[Row<u32>] = &[
    Row {
        what: "the seam of two walls that reach behind the ray: the one it is said to hit it misses by a rounding, and its box",
        hit: true,
        ray: [[0x40EDA7FC, 0x424490D0, 0xC2D976B2], [0xBEC86F08, 0xBF25911C, 0x3F27924D]],
        triangles: &[
            [
                [0x40D8A86D, 0x42403AB4, 0xC30076A5],
                [0x40D8A86D, 0x42403AB4, 0xC2B0ED49],
                [0xC0EBE3F3, 0x4278CC40, 0xC30076A5],
            ],
            [
                [0x40D8A86D, 0x42403AB4, 0xC30076A5],
                [0x41A74D33, 0x4278CC40, 0xC30076A5],
                [0x40D8A86D, 0x42403AB4, 0xC2B0ED49],
            ],
        ],
    },
    Row {
        what: "a triangle without area (BadCases of pbrt-v4, shapes_test.cpp)",
        hit: false,
        ray: [[0xC4872F56, 0x42C7FFFA, 0x42AF8A4C], [0xC2006DE0, 0xC3375B1A, 0xC3109B8E]],
        triangles: &[[
            [0xC48B2E8C, 0xC29E1967, 0xC260F907],
            [0xC48B2E8C, 0xC2AE2F3E, 0xC260F907],
            [0xC48B2E8C, 0xC29E6B04, 0xC260F907],
        ]],
    },
    Row {
        what: "along the plane of a triangle, through its middle",
        hit: false,
        ray: [[0xBF800000, 0x3E800000, 0x00000000], [0x3F800000, 0x00000000, 0x00000000]],
        triangles: &[[
            [0x00000000, 0x00000000, 0x00000000],
            [0x3F800000, 0x00000000, 0x00000000],
            [0x00000000, 0x3F800000, 0x00000000],
        ]],
    },
    Row {
        what: "along a slanted plane",
        hit: false,
        ray: [[0x40000000, 0xBF800000, 0x00000000], [0xC0000000, 0x3F800000, 0x3F800000]],
        triangles: &[[
            [0x3F800000, 0x00000000, 0x00000000],
            [0x00000000, 0x3F800000, 0x00000000],
            [0x00000000, 0x00000000, 0x3F800000],
        ]],
    },
    Row {
        what: "along an edge",
        hit: false,
        ray: [[0xBF800000, 0x00000000, 0x00000000], [0x3F800000, 0x00000000, 0x00000000]],
        triangles: &[[
            [0x00000000, 0x00000000, 0x00000000],
            [0x3F800000, 0x00000000, 0x00000000],
            [0x00000000, 0x3F800000, 0x00000000],
        ]],
    },
    Row {
        what: "through the corner that six triangles share",
        hit: true,
        ray: [[0x00000000, 0x00000000, 0x00000000], [0x3DCCCCCD, 0x3D8F5C29, 0xC0133333]],
        triangles: &[
            [
                [0x3DCCCCCD, 0x3D8F5C29, 0xC0133333],
                [0x3F800000, 0x00000000, 0xC0000000],
                [0x3F000000, 0x3F600000, 0xBFF33333],
            ],
            [
                [0x3DCCCCCD, 0x3D8F5C29, 0xC0133333],
                [0x3F000000, 0x3F600000, 0xBFF33333],
                [0xBF000000, 0x3F600000, 0xBFE66666],
            ],
            [
                [0x3DCCCCCD, 0x3D8F5C29, 0xC0133333],
                [0xBF000000, 0x3F600000, 0xBFE66666],
                [0xBF800000, 0x00000000, 0xBFD9999A],
            ],
            [
                [0x3DCCCCCD, 0x3D8F5C29, 0xC0133333],
                [0xBF800000, 0x00000000, 0xBFD9999A],
                [0xBF000000, 0xBF600000, 0xBFCCCCCD],
            ],
            [
                [0x3DCCCCCD, 0x3D8F5C29, 0xC0133333],
                [0xBF000000, 0xBF600000, 0xBFCCCCCD],
                [0x3F000000, 0xBF600000, 0xBFC00000],
            ],
            [
                [0x3DCCCCCD, 0x3D8F5C29, 0xC0133333],
                [0x3F000000, 0xBF600000, 0xBFC00000],
                [0x3F800000, 0x00000000, 0xC0000000],
            ],
        ],
    },
    Row {
        what: "through the middle of an edge of one triangle",
        hit: true,
        ray: [[0x3F000000, 0x3F000000, 0x3F800000], [0x00000000, 0x80000000, 0xBF800000]],
        triangles: &[[
            [0x00000000, 0x00000000, 0x00000000],
            [0x3F800000, 0x00000000, 0x00000000],
            [0x00000000, 0x3F800000, 0x00000000],
        ]],
    },
    Row {
        what: "one place outside of that edge",
        hit: false,
        ray: [[0x3F000000, 0x3F000001, 0x3F800000], [0x00000000, 0x00000000, 0xBF800000]],
        triangles: &[[
            [0x00000000, 0x00000000, 0x00000000],
            [0x3F800000, 0x00000000, 0x00000000],
            [0x00000000, 0x3F800000, 0x00000000],
        ]],
    },
    Row {
        what: "grazing the front",
        hit: true,
        ray: [[0xBF800000, 0x35800000, 0x3E800000], [0x3F800000, 0xB5800000, 0x00000000]],
        triangles: &[[
            [0xBE800000, 0x00000000, 0x00000000],
            [0x3F800000, 0x00000000, 0x00000000],
            [0x3E800000, 0x00000000, 0x3F800000],
        ]],
    },
    Row {
        what: "grazing, but above",
        hit: false,
        ray: [[0xBF800000, 0x35800000, 0x3E800000], [0x3F800000, 0xB4800000, 0x00000000]],
        triangles: &[[
            [0xBE800000, 0x00000000, 0x00000000],
            [0x3F800000, 0x00000000, 0x00000000],
            [0x3E800000, 0x00000000, 0x3F800000],
        ]],
    },
    Row {
        what: "from the very point of a triangle",
        hit: false,
        ray: [[0x3E800000, 0x3E800000, 0x00000000], [0x00000000, 0x00000000, 0xBF800000]],
        triangles: &[[
            [0x00000000, 0x00000000, 0x00000000],
            [0x3F800000, 0x00000000, 0x00000000],
            [0x00000000, 0x3F800000, 0x00000000],
        ]],
    },
    Row {
        what: "from one place before a triangle",
        hit: true,
        ray: [[0x3E800000, 0x3E800000, 0x3F800001], [0x00000000, 0x00000000, 0xBF800000]],
        triangles: &[[
            [0x00000000, 0x00000000, 0x3F800000],
            [0x3F800000, 0x00000000, 0x3F800000],
            [0x00000000, 0x3F800000, 0x3F800000],
        ]],
    },
    Row {
        what: "a needle through which the axis runs",
        hit: true,
        ray: [[0x00000000, 0x00000000, 0x3F800000], [0x80000000, 0x00000000, 0xBF800000]],
        triangles: &[[
            [0xBF800000, 0xB58637BD, 0x00000000],
            [0x3F800000, 0xB58637BD, 0x00000000],
            [0x00000000, 0x358637BD, 0x00000000],
        ]],
    },
    Row {
        what: "through an edge of two triangles, both of which Moller and Trumbore's test misses",
        hit: true,
        ray: [[0x3F595D68, 0xBF36CFF6, 0xBF3606E0], [0xBF43772C, 0x3F9A91B2, 0x3F24B26C]],
        triangles: &[
            [
                [0xBE612098, 0x3F730AF0, 0x3E80448C],
                [0x3EC64510, 0x3D305574, 0xBEC39DD7],
                [0xBE55E684, 0x3F61C220, 0xBF18FBE5],
            ],
            [
                [0x3EC64510, 0x3D305574, 0xBEC39DD7],
                [0xBE612098, 0x3F730AF0, 0x3E80448C],
                [0x3F79F7D4, 0x3F0440AA, 0xBE8F9404],
            ],
        ],
    },
    Row {
        what: "through an edge of two triangles, both of which Moller and Trumbore's test misses",
        hit: true,
        ray: [[0x3FDE2595, 0x3FAEF970, 0x401CBE65], [0xBFB980AC, 0xBF796C02, 0xC00DDE0E]],
        triangles: &[
            [
                [0x3D130705, 0x3EB5D708, 0xBC5F8DE1],
                [0x3F53D63C, 0x3EF29563, 0x3F43ACAD],
                [0xBF46C6BD, 0xBF1BC4E3, 0xBF5E5C04],
            ],
            [
                [0x3F53D63C, 0x3EF29563, 0x3F43ACAD],
                [0x3D130705, 0x3EB5D708, 0xBC5F8DE1],
                [0x3F289C91, 0x3F6CF691, 0xBF78D62B],
            ],
        ],
    },
];

const DOUBLE: &[Row<u64>] = &[
    Row {
        what: "through an edge of two triangles, both of which Moller and Trumbore's test misses",
        hit: true,
        ray: [
            [0xC0068B1BB6C9399A, 0x3FF3DE5FCAF86C7E, 0xBFE8252AC6DC379C],
            [0x40031D38E0C66A22, 0xBFF2B0CF7A951237, 0x3FF3E22D9C9DFB3A],
        ],
        triangles: &[
            [
                [0xBFDB9F4BD81B5DCC, 0x3FD303984A28F560, 0x3FD91D9B14533F14],
                [0xBFDA88206210BC34, 0xBFEFE7962303EB5A, 0x3FEE4D2C5304EC34],
                [0xBFD9CDFD1D072ED4, 0xBFD7CF4E82EE2C88, 0x3FE911CB4F42C230],
            ],
            [
                [0xBFDA88206210BC34, 0xBFEFE7962303EB5A, 0x3FEE4D2C5304EC34],
                [0xBFDB9F4BD81B5DCC, 0x3FD303984A28F560, 0x3FD91D9B14533F14],
                [0x3FC5CD3D09A9A458, 0xBFAD60FFC70573C0, 0x3FE17D5EDACC2E94],
            ],
        ],
    },
    Row {
        what: "through an edge of two triangles, both of which Moller and Trumbore's test misses",
        hit: true,
        ray: [
            [0xBFEA8810F0E40920, 0xBFFF9C24DA62857B, 0xBFFAC00FC5806438],
            [0x3FFB0EAF7EAC6451, 0x3FFFB88246B347A4, 0x3FFEADC5E7AEF94C],
        ],
        triangles: &[
            [
                [0x3FEC1A54787989EA, 0x3FC4FEFCCD88C908, 0xBFDDB7A2ADF5DD8C],
                [0x3FEB816DB93FC6DA, 0xBF90F2557FC8F3C0, 0x3FD680A48ABFBEB0],
                [0xBFA889417F89E8C0, 0xBFE21CFFCEA877DA, 0x3FD8A58B9F67A720],
            ],
            [
                [0x3FEB816DB93FC6DA, 0xBF90F2557FC8F3C0, 0x3FD680A48ABFBEB0],
                [0x3FEC1A54787989EA, 0x3FC4FEFCCD88C908, 0xBFDDB7A2ADF5DD8C],
                [0x3FE15202848B808A, 0xBFE3CA1F025D8F10, 0xBFB485E36CAD56C0],
            ],
        ],
    },
];

/// Whether a ray meets the closed triangle, its edges included, at some t > 0. None is met along its plane, and none
/// without area.
fn meets<R: Real>(ray: &Ray<R>, corners: [Vec3<R>; 3]) -> bool {
    let (o, d) = (ExactVec::new::<R>(ray.origin), ExactVec::new::<R>(ray.direction));
    let [a, b, c] = corners.map(ExactVec::new::<R>);
    let normal = (&b - &a).cross(&(&c - &a));
    let (along, zero) = (d.dot(&normal), exact(0.0));
    // t > 0 is the same as numerator and denominator of one sign.
    if (&a - &o).dot(&normal) * &along <= zero {
        return false;
    }
    [(&a, &b), (&b, &c), (&c, &a)].into_iter().all(|(p, q)| (p - &o).dot(&d.cross(&(q - p))) * &along <= zero)
}

fn kept_rays_hit_and_miss_as_they_should<R: Real>() {
    let right = Trials::of::<R>("N15", "kept rays");
    let check = |what: &str, hit: bool, [origin, direction]: [[f64; 3]; 2], triangles: &[[[f64; 3]; 3]]| {
        let ray = Ray::<R>::new(v::<R>(origin), v::<R>(direction));
        let mut scene = one_material::<R>();
        for corners in triangles {
            scene.mesh(&Mesh { positions: corners.to_vec(), triangles: vec![[0, 1, 2]] }, 0);
        }
        let truth = triangles.iter().any(|corners| meets(&ray, corners.map(v::<R>)));
        assert_eq!(hit, truth, "{what}: the row is wrong");
        for structure in STRUCTURES {
            scene.lend(structure, |scene| {
                let found = scene.intersect(&ray);
                let same = found.is_some() == hit && scene.occluded(&ray) == hit;
                right.holds(same, || format!("{what}, {structure:?}: {found:?}"));
            });
        }
    };
    for Row { what, hit, ray, triangles } in SINGLE {
        let float = |point: [u32; 3]| point.map(|bits| f64::from(f32::from_bits(bits)));
        let triangles: Vec<_> = triangles.iter().map(|corners| corners.map(float)).collect();
        check(what, *hit, ray.map(float), &triangles);
    }
    for Row { what, hit, ray, triangles } in if R::WIDE_IS_SELF { DOUBLE } else { &[] } {
        let float = |point: [u64; 3]| point.map(f64::from_bits);
        let triangles: Vec<_> = triangles.iter().map(|corners| corners.map(float)).collect();
        check(what, *hit, ray.map(float), &triangles);
    }
    right.end(STRUCTURES.len() as u64 * SINGLE.len() as u64);
}

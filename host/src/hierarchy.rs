//! The kernel's hierarchy in memory of its own, built on all threads.

use std::marker::PhantomData;

use memmap2::MmapMut;
use ocellus_kernel::Real;
use ocellus_kernel::bvh::{self, BuildItem, Bvh, Join, Node, Structure};
use ocellus_kernel::shape::{Geometry, SphereQuad, TriangleQuad};

/// Memory for the hierarchy of one scene.
#[derive(Debug, Default)]
pub struct Hierarchy<R: Real> {
    nodes: Room<Node<R>>,
    sphere_quads: Room<SphereQuad<R>>,
    triangle_quads: Room<TriangleQuad<R>>,
}

impl<R: Real> Hierarchy<R> {
    /// Builds the hierarchy of `geometry`, in place of any before, on the threads of the pool that it is called in. It
    /// is the same on any number of them.
    ///
    /// # Errors
    /// Too little memory, or too many primitives: the cause in words.
    pub fn build(&mut self, geometry: &Geometry<'_, R>, structure: Structure) -> Result<Bvh<'_, R>, String> {
        let mut scratch = Room::<BuildItem<R>>::new(geometry.len())?;
        self.nodes = Room::new(structure.required_nodes(geometry))?;
        let plan = bvh::plan(geometry, structure, self.nodes.all(), scratch.all(), &Threads);
        let plan = plan.map_err(|error| error.to_string())?;
        let [spheres, triangles] = plan.required_quads();
        self.sphere_quads = Room::new(spheres)?;
        self.triangle_quads = Room::new(triangles)?;
        plan.fill(self.sphere_quads.all(), self.triangle_quads.all(), &Threads).map_err(|error| error.to_string())
    }
}

/// Builds on the threads of the pool that it is called in.
struct Threads;

impl Join for Threads {
    fn join<A: Send, B: Send>(&self, a: impl FnOnce() -> A + Send, b: impl FnOnce() -> B + Send) -> (A, B) {
        rayon::join(a, b)
    }
}

/// What zeros are a value of.
///
/// # Safety
/// All its bytes may be zero.
unsafe trait Zeros {}

// SAFETY: these are made of numbers alone. (`Real` is sealed: f32 and f64.)
unsafe impl<R: Real> Zeros for Node<R> {}
// SAFETY: as above.
unsafe impl<R: Real> Zeros for SphereQuad<R> {}
// SAFETY: as above.
unsafe impl<R: Real> Zeros for TriangleQuad<R> {}
// SAFETY: as above.
unsafe impl<R: Real> Zeros for BuildItem<R> {}

/// Zeros that are not there before they are touched, by whichever thread; in large pages where the system has them. The
/// builder asks for as much as it can ever need and touches a quarter of it, and rays that go anywhere meet fewer pages.
#[derive(Debug)]
struct Room<T> {
    bytes: Option<MmapMut>,
    kind: PhantomData<T>,
}

impl<T> Default for Room<T> {
    fn default() -> Self {
        Self { bytes: None, kind: PhantomData }
    }
}

impl<T: Zeros> Room<T> {
    fn new(count: usize) -> Result<Self, String> {
        if count == 0 {
            return Ok(Self::default());
        }
        let bytes = count.saturating_mul(size_of::<T>());
        let map = MmapMut::map_anon(bytes).map_err(|error| format!("no {bytes} bytes for the hierarchy: {error}"))?;
        // Only a wish: nothing but time depends on it.
        #[cfg(target_os = "linux")]
        let _ = map.advise(memmap2::Advice::HugePage);
        Ok(Self { bytes: Some(map), kind: PhantomData })
    }

    fn all(&mut self) -> &mut [T] {
        let bytes = self.bytes.as_deref_mut().unwrap_or_default();
        // SAFETY: zeros are a value of `T`, and what is there now was a `T` when it was written. Pages are aligned to
        // more than any `T` is, so that nothing is left out.
        unsafe { bytes.align_to_mut() }.1
    }
}

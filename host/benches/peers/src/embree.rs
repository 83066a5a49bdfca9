//! Embree 4, loaded at run time through its C interface.
#![allow(unsafe_code, reason = "Embree is a C library")]

use std::ffi::{CString, c_char, c_void};
use std::marker::PhantomData;
use std::path::Path;
use std::ptr;
use std::sync::atomic::{AtomicIsize, Ordering};

use libloading::Library;

use crate::isa::Isa;
use crate::measure::{repeat, seconds};
use crate::mesh::Mesh;
use crate::peer::{Answer, Peer, Ray, Row};

/// A device, a scene or a geometry.
type Handle = *mut c_void;

/// `RTCRay`.
#[repr(C, align(16))]
struct RtcRay {
    origin: [f32; 3],
    tnear: f32,
    direction: [f32; 3],
    time: f32,
    tfar: f32,
    mask: u32,
    id: u32,
    flags: u32,
}

/// `RTCHit` of one level of instances; the last field is there only in libraries with arrays of instances.
#[repr(C, align(16))]
struct RtcHit {
    ng: [f32; 3],
    u: f32,
    v: f32,
    primitive: u32,
    geometry: u32,
    instance: u32,
    instance_primitive: u32,
}

/// `RTCRayHit`.
#[repr(C)]
struct RtcRayHit {
    ray: RtcRay,
    hit: RtcHit,
}

/// `RTC_INVALID_GEOMETRY_ID`.
const NONE: u32 = u32::MAX;

/// Declares functions of the library and how they are found in it.
macro_rules! functions {
    ($($name:ident $symbol:literal ($($argument:ty),*) $(-> $result:ty)?;)*) => {
        /// The functions of the library that are used here.
        pub(crate) struct Embree {
            $($name: unsafe extern "C" fn($($argument),*) $(-> $result)?,)*
        }

        impl Embree {
            fn of(library: &Library) -> Result<Self, libloading::Error> {
                // SAFETY: these are the types of Embree 4's header.
                unsafe { Ok(Self { $($name: *library.get($symbol)?,)* }) }
            }
        }
    };
}

functions! {
    new_device b"rtcNewDevice" (*const c_char) -> Handle;
    release_device b"rtcReleaseDevice" (Handle);
    device_property b"rtcGetDeviceProperty" (Handle, i32) -> isize;
    device_error b"rtcGetDeviceError" (Handle) -> i32;
    monitor_memory b"rtcSetDeviceMemoryMonitorFunction"
        (Handle, unsafe extern "C" fn(*mut c_void, isize, bool) -> bool, *mut c_void);
    new_scene b"rtcNewScene" (Handle) -> Handle;
    release_scene b"rtcReleaseScene" (Handle);
    set_scene_flags b"rtcSetSceneFlags" (Handle, i32);
    set_scene_build_quality b"rtcSetSceneBuildQuality" (Handle, i32);
    commit_scene b"rtcCommitScene" (Handle);
    new_geometry b"rtcNewGeometry" (Handle, i32) -> Handle;
    release_geometry b"rtcReleaseGeometry" (Handle);
    set_shared_buffer b"rtcSetSharedGeometryBuffer"
        (Handle, i32, u32, i32, *const c_void, usize, usize, usize);
    commit_geometry b"rtcCommitGeometry" (Handle);
    attach_geometry b"rtcAttachGeometry" (Handle, Handle) -> u32;
    intersect b"rtcIntersect1" (Handle, *mut RtcRayHit, *const c_void);
    occluded b"rtcOccluded1" (Handle, *mut RtcRay, *const c_void);
}

// Values of the header's enumerations.
const PROPERTY_VERSION: i32 = 0;
const TYPE_TRIANGLE: i32 = 0;
const BUFFER_INDEX: i32 = 0;
const BUFFER_VERTEX: i32 = 1;
const FORMAT_UINT3: i32 = 0x5003;
const FORMAT_FLOAT3: i32 = 0x9003;
const ROBUST: i32 = 1 << 2;
const MEDIUM: i32 = 1;
const HIGH: i32 = 2;

/// Kinds of scenes: the name of the row, flags and build quality. Medium is the library's own default.
const KINDS: [(&str, i32, i32); 3] =
    [("Embree ROBUST", ROBUST, MEDIUM), ("Embree", 0, MEDIUM), ("Embree high quality", 0, HIGH)];

impl Embree {
    /// Loads the library and keeps it.
    pub(crate) fn load(path: &Path) -> Result<Self, String> {
        // SAFETY: its constructors do nothing that matters here, and it is never unloaded.
        let library = unsafe { Library::new(path) }.map_err(|error| error.to_string())?;
        Self::of(Box::leak(Box::new(library))).map_err(|error| format!("{}: {error}", path.display()))
    }

    /// Its version, as in 40400.
    pub(crate) fn version(&self) -> Result<isize, String> {
        let device = self.device(Isa::Baseline, 1)?;
        // SAFETY: the device is one, and not used any more.
        unsafe {
            let version = (self.device_property)(device, PROPERTY_VERSION);
            (self.release_device)(device);
            Ok(version)
        }
    }

    /// The rows that are wanted, of every instruction set that this machine has.
    pub(crate) fn rows<'a>(
        &'a self,
        mesh: &'a Mesh,
        builds: usize,
        wanted: impl Fn(&str) -> bool,
    ) -> Result<Vec<Row<'a>>, String> {
        let mut rows = Vec::new();
        for (name, flags, quality) in KINDS {
            for isa in Isa::available().rev().filter(|isa| wanted(&Row::title(name, *isa))) {
                let build = |threads| {
                    repeat(builds, || {
                        let scene = Scene::new(self, mesh, isa, threads, flags, quality)?;
                        Ok((scene.build_seconds, scene))
                    })
                };
                let (on_two, _) = build(2)?;
                let (on_one, scene) = build(1)?;
                rows.push(Row {
                    name,
                    isa,
                    build_seconds: [Some(on_one), Some(on_two)],
                    bytes_per_triangle: scene.bytes.load(Ordering::SeqCst) as f64 / mesh.triangles.len() as f64,
                    peer: Box::new(scene),
                });
            }
        }
        Ok(rows)
    }

    fn device(&self, isa: Isa, threads: usize) -> Result<Handle, String> {
        let isa = match isa {
            Isa::Baseline => "sse4.2",
            Isa::Avx2 => "avx2",
            Isa::Avx512 => "avx512",
        };
        let settings = format!("threads={threads},set_affinity=0,isa={isa}");
        let text = CString::new(settings.as_str()).map_err(|error| error.to_string())?;
        // SAFETY: the text ends with a zero; null asks for the thread's last error.
        unsafe {
            let device = (self.new_device)(text.as_ptr());
            if device.is_null() {
                return Err(format!("Embree makes no device with {settings}: error {}", (self.device_error)(device)));
            }
            Ok(device)
        }
    }
}

/// A committed scene of one mesh with a device of its own.
struct Scene<'a> {
    embree: &'a Embree,
    device: Handle,
    scene: Handle,
    build_seconds: f64,
    /// What Embree has allocated and not freed, kept by the monitor.
    bytes: Box<AtomicIsize>,
    /// The library reads the indices of the mesh, and these corners: sixteen bytes at a time, so there is one more.
    _positions: Vec<[f32; 3]>,
    _mesh: PhantomData<&'a Mesh>,
}

impl<'a> Scene<'a> {
    fn new(
        embree: &'a Embree,
        mesh: &'a Mesh,
        isa: Isa,
        threads: usize,
        flags: i32,
        quality: i32,
    ) -> Result<Self, String> {
        let positions: Vec<[f32; 3]> = mesh.positions.iter().copied().chain([[0.0; 3]]).collect();
        let bytes = Box::new(AtomicIsize::new(0));
        let device = embree.device(isa, threads)?;
        // SAFETY: handles come from the library and are released once; the arrays live as long as the scene does, and
        // the counter as long as the device, behind a box that does not move it.
        let (build_seconds, scene) = seconds(threads, || unsafe {
            (embree.monitor_memory)(device, count_bytes, ptr::from_ref(&*bytes).cast_mut().cast());
            let scene = (embree.new_scene)(device);
            (embree.set_scene_flags)(scene, flags);
            (embree.set_scene_build_quality)(scene, quality);
            let geometry = (embree.new_geometry)(device, TYPE_TRIANGLE);
            let share = |buffer, format, data: *const c_void, count| {
                (embree.set_shared_buffer)(geometry, buffer, 0, format, data, 0, 12, count);
            };
            share(BUFFER_VERTEX, FORMAT_FLOAT3, positions.as_ptr().cast(), mesh.positions.len());
            share(BUFFER_INDEX, FORMAT_UINT3, mesh.triangles.as_ptr().cast(), mesh.triangles.len());
            (embree.commit_geometry)(geometry);
            (embree.attach_geometry)(scene, geometry);
            (embree.release_geometry)(geometry);
            (embree.commit_scene)(scene);
            scene
        });
        let made = Self { embree, device, scene, build_seconds, bytes, _positions: positions, _mesh: PhantomData };
        // SAFETY: the device is one.
        match unsafe { (embree.device_error)(device) } {
            0 => Ok(made),
            error => Err(format!("Embree cannot build {}: error {error}", mesh.name)),
        }
    }
}

/// Adds what the library allocates and frees to the counter at `user`.
unsafe extern "C" fn count_bytes(user: *mut c_void, bytes: isize, _post: bool) -> bool {
    // SAFETY: `user` is the counter that the function was registered with, and outlives the device.
    unsafe { &*user.cast::<AtomicIsize>() }.fetch_add(bytes, Ordering::SeqCst);
    true
}

impl Drop for Scene<'_> {
    fn drop(&mut self) {
        // SAFETY: nothing else releases them, and nothing uses them any more.
        unsafe {
            (self.embree.release_scene)(self.scene);
            (self.embree.release_device)(self.device);
        }
    }
}

impl Peer for Scene<'_> {
    fn closest(&self, rays: &[Ray], answers: &mut [Answer]) {
        for (ray, answer) in rays.iter().zip(answers) {
            let hit = RtcHit {
                ng: [0.0; 3],
                u: 0.0,
                v: 0.0,
                primitive: NONE,
                geometry: NONE,
                instance: NONE,
                instance_primitive: NONE,
            };
            let mut query = RtcRayHit { ray: rtc_ray(ray), hit };
            // SAFETY: the scene is committed, the query aligned and ours; no arguments mean the defaults.
            unsafe { (self.embree.intersect)(self.scene, &raw mut query, ptr::null()) };
            let RtcRayHit { ray, hit } = query;
            *answer = if hit.geometry == NONE {
                Answer::MISS
            } else {
                Answer { t: ray.tfar, u: hit.u, v: hit.v, primitive: hit.primitive }
            };
        }
    }

    fn any(&self, rays: &[Ray], answers: &mut [Answer]) {
        for (ray, answer) in rays.iter().zip(answers) {
            let mut query = rtc_ray(ray);
            // SAFETY: as above.
            unsafe { (self.embree.occluded)(self.scene, &raw mut query, ptr::null()) };
            // It says so by an end of t below everything.
            *answer = Answer::any(query.tfar < 0.0);
        }
    }
}

#[inline(always)]
fn rtc_ray(ray: &Ray) -> RtcRay {
    let Ray { origin, tnear, direction, tfar } = *ray;
    RtcRay { origin, tnear, direction, time: 0.0, tfar, mask: u32::MAX, id: 0, flags: 0 }
}

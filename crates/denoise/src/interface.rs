//! The functions of the library's C interface that are needed, and what makes them safe to call.
//!
//! Signatures, names of parameters and numbers are those of `OpenImageDenoise/oidn.h`, version 2. Pictures are handed
//! over through the library's own buffers, so that it keeps no pointer of ours beyond a call.

use crate::DenoiseError;
use libloading::Library;
use std::ffi::{CStr, c_char, c_int, c_void};
use std::mem::ManuallyDrop;
use std::path::Path;
use std::ptr::{self, NonNull};

/// `OIDNDevice`, `OIDNBuffer` and `OIDNFilter` are pointers to what only the library knows.
type Handle = *mut c_void;

/// `OIDN_DEVICE_TYPE_CPU`.
const CPU: c_int = 1;
/// `OIDN_FORMAT_FLOAT3`.
const FLOAT3: c_int = 3;
/// `OIDN_ERROR_NONE`.
const NO_ERROR: c_int = 0;
const PIXEL_BYTES: usize = size_of::<[f32; 3]>();

macro_rules! functions {
    ($($(#[$doc:meta])* $field:ident = $name:literal: fn($($argument:ty),*) $(-> $result:ty)?;)*) => {
        /// The functions; they stay valid for as long as the program runs, because the library is never unloaded:
        /// threads that it started may outlive its objects.
        #[derive(Clone, Copy)]
        pub(crate) struct Functions {
            $($(#[$doc])* $field: unsafe extern "C" fn($($argument),*) $(-> $result)?,)*
        }

        impl Functions {
            /// Looks them up.
            pub(crate) fn of(library: Library, path: &Path) -> Result<Self, DenoiseError> {
                let library = ManuallyDrop::new(library);
                let wrong = |error: libloading::Error| DenoiseError::WrongLibrary {
                    library: path.display().to_string(),
                    reason: error.to_string(),
                };
                Ok(Functions {
                    $(
                        // SAFETY: the type is that of the function of this name in version 2 of the interface, which
                        // its makers keep compatible; `Device::open` asks for the version before anything else.
                        $field: *unsafe { library.get($name.to_bytes_with_nul()) }.map_err(wrong)?,
                    )*
                })
            }
        }
    };
}

functions! {
    new_device = c"oidnNewDevice": fn(c_int) -> Handle;
    set_device_int = c"oidnSetDeviceInt": fn(Handle, *const c_char, c_int);
    device_int = c"oidnGetDeviceInt": fn(Handle, *const c_char) -> c_int;
    commit_device = c"oidnCommitDevice": fn(Handle);
    /// Takes no device for errors of making one.
    device_error = c"oidnGetDeviceError": fn(Handle, *mut *const c_char) -> c_int;
    release_device = c"oidnReleaseDevice": fn(Handle);
    new_buffer = c"oidnNewBuffer": fn(Handle, usize) -> Handle;
    write_buffer = c"oidnWriteBuffer": fn(Handle, usize, usize, *const c_void);
    read_buffer = c"oidnReadBuffer": fn(Handle, usize, usize, *mut c_void);
    release_buffer = c"oidnReleaseBuffer": fn(Handle);
    new_filter = c"oidnNewFilter": fn(Handle, *const c_char) -> Handle;
    /// Filter, name, buffer, format, width, height, first byte, bytes per pixel, bytes per row (0: without gaps).
    set_filter_image = c"oidnSetFilterImage":
        fn(Handle, *const c_char, Handle, c_int, usize, usize, usize, usize, usize);
    set_filter_bool = c"oidnSetFilterBool": fn(Handle, *const c_char, bool);
    commit_filter = c"oidnCommitFilter": fn(Handle);
    execute_filter = c"oidnExecuteFilter": fn(Handle);
    release_filter = c"oidnReleaseFilter": fn(Handle);
}

/// What helps to tell noise from detail.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Guide {
    Albedo,
    Normal,
}

impl Guide {
    fn name(self) -> &'static CStr {
        match self {
            Guide::Albedo => c"albedo",
            Guide::Normal => c"normal",
        }
    }
}

/// What the library computes on.
pub(crate) struct Device {
    functions: Functions,
    /// A device of the library, released with this one.
    handle: NonNull<c_void>,
}

impl Device {
    /// Starts the processor as a device.
    pub(crate) fn open(functions: Functions, threads: Option<usize>) -> Result<Self, DenoiseError> {
        // SAFETY: takes any number; answers an unknown one with an error.
        let handle = unsafe { (functions.new_device)(CPU) };
        let Some(handle) = NonNull::new(handle) else {
            return Err(error_of(functions, ptr::null_mut(), "starting"));
        };
        let device = Device { functions, handle };
        let major = device.number(c"versionMajor");
        if major != 2 {
            let reason = format!("it is version {major}");
            return Err(DenoiseError::WrongLibrary {
                library: "the library that was found".to_owned(),
                reason,
            });
        }
        if let Some(threads) = threads.and_then(|threads| c_int::try_from(threads).ok()) {
            // SAFETY: a device and a string that ends with 0, which is only read during the call.
            unsafe { (functions.set_device_int)(handle.as_ptr(), c"numThreads".as_ptr(), threads) };
        }
        // SAFETY: a device.
        unsafe { (functions.commit_device)(handle.as_ptr()) };
        device.check("starting")?;
        Ok(device)
    }

    /// A property of the device, 0 if there is none of this name.
    pub(crate) fn number(&self, name: &CStr) -> c_int {
        // SAFETY: a device and a string that ends with 0, which is only read during the call.
        unsafe { (self.functions.device_int)(self.handle.as_ptr(), name.as_ptr()) }
    }

    /// A buffer with a copy of pixels.
    pub(crate) fn buffer(&self, pixels: &[[f32; 3]]) -> Result<Buffer<'_>, DenoiseError> {
        let bytes = size_of_val(pixels);
        // SAFETY: a device; a size that cannot be had is answered with an error.
        let handle = unsafe { (self.functions.new_buffer)(self.handle.as_ptr(), bytes) };
        let Some(handle) = NonNull::new(handle) else {
            return Err(self.error("taking memory"));
        };
        let buffer = Buffer { device: self, handle, bytes };
        // A buffer without memory may come with an error, too.
        self.check("taking memory")?;
        // SAFETY: as many bytes are read as the slice has, and the buffer is as large; the pointer is not kept.
        unsafe { (self.functions.write_buffer)(handle.as_ptr(), 0, bytes, pixels.as_ptr().cast()) };
        self.check("taking the picture")?;
        Ok(buffer)
    }

    /// Denoises what helps, in place.
    pub(crate) fn denoise_guide(
        &self,
        size: (usize, usize),
        guide: Guide,
        pixels: &Buffer<'_>,
    ) -> Result<(), DenoiseError> {
        let filter = self.filter()?;
        filter.image(guide.name(), pixels, size);
        filter.image(c"output", pixels, size);
        filter.execute("denoising albedo or normals")
    }

    /// Denoises the picture, in place, with the help of what has no noise.
    pub(crate) fn denoise_radiance(
        &self,
        size: (usize, usize),
        pixels: &Buffer<'_>,
        albedo: &Buffer<'_>,
        normal: &Buffer<'_>,
    ) -> Result<(), DenoiseError> {
        let filter = self.filter()?;
        filter.image(c"color", pixels, size);
        filter.image(Guide::Albedo.name(), albedo, size);
        filter.image(Guide::Normal.name(), normal, size);
        filter.image(c"output", pixels, size);
        // Radiance has no upper bound; what helps was denoised before.
        filter.switch_on(c"hdr");
        filter.switch_on(c"cleanAux");
        filter.execute("denoising")
    }

    /// A filter for pictures made by following rays.
    fn filter(&self) -> Result<Filter<'_>, DenoiseError> {
        // SAFETY: a device and a string that ends with 0, which is only read during the call.
        let handle = unsafe { (self.functions.new_filter)(self.handle.as_ptr(), c"RT".as_ptr()) };
        let handle = NonNull::new(handle).ok_or_else(|| self.error("making a filter"))?;
        Ok(Filter { device: self, handle })
    }

    /// What went wrong since it was asked last.
    fn check(&self, doing: &'static str) -> Result<(), DenoiseError> {
        match taken_error(self.functions, self.handle.as_ptr()) {
            None => Ok(()),
            Some(reason) => Err(DenoiseError::Failed { doing, reason }),
        }
    }

    fn error(&self, doing: &'static str) -> DenoiseError {
        error_of(self.functions, self.handle.as_ptr(), doing)
    }
}

impl Drop for Device {
    fn drop(&mut self) {
        // SAFETY: the handle came from `new_device` and is released once; buffers and filters borrow this device, so
        // they are gone.
        unsafe { (self.functions.release_device)(self.handle.as_ptr()) };
    }
}

fn error_of(functions: Functions, device: Handle, doing: &'static str) -> DenoiseError {
    let reason = taken_error(functions, device).unwrap_or_else(|| "it does not say why".to_owned());
    DenoiseError::Failed { doing, reason }
}

/// Takes the error that this thread has at the library, if there is one.
fn taken_error(functions: Functions, device: Handle) -> Option<String> {
    let mut message = ptr::null();
    // SAFETY: a device or none, and a place for a pointer.
    let code = unsafe { (functions.device_error)(device, &raw mut message) };
    if code == NO_ERROR {
        return None;
    }
    if message.is_null() {
        return Some(format!("error {code}"));
    }
    // SAFETY: not null, so a string that ends with 0 and is valid until the library is called again.
    Some(unsafe { CStr::from_ptr(message) }.to_string_lossy().into_owned())
}

/// Pixels that the library can reach.
pub(crate) struct Buffer<'a> {
    device: &'a Device,
    /// A buffer of the library, released with this one.
    handle: NonNull<c_void>,
    bytes: usize,
}

impl Buffer<'_> {
    /// A copy of the first pixels.
    pub(crate) fn read(&self, pixels: usize) -> Result<Vec<[f32; 3]>, DenoiseError> {
        let mut copy = vec![[0.0; 3]; pixels];
        let bytes = size_of_val(copy.as_slice()).min(self.bytes);
        let read = self.device.functions.read_buffer;
        // SAFETY: no more bytes are written than the vector has, nor read than the buffer has; all bits are floats.
        unsafe { read(self.handle.as_ptr(), 0, bytes, copy.as_mut_ptr().cast()) };
        self.device.check("handing the picture back")?;
        Ok(copy)
    }
}

impl Drop for Buffer<'_> {
    fn drop(&mut self) {
        // SAFETY: the handle came from `new_buffer` and is released once; filters that use it hold it themselves.
        unsafe { (self.device.functions.release_buffer)(self.handle.as_ptr()) };
    }
}

/// A filter in the making.
struct Filter<'a> {
    device: &'a Device,
    /// A filter of the library, released with this one.
    handle: NonNull<c_void>,
}

impl Filter<'_> {
    fn image(&self, name: &CStr, pixels: &Buffer<'_>, (width, height): (usize, usize)) {
        let set = self.device.functions.set_filter_image;
        let (filter, buffer) = (self.handle.as_ptr(), pixels.handle.as_ptr());
        // SAFETY: a filter and a buffer of the same device, a string that ends with 0; the library itself compares
        // the size of the image with that of the buffer.
        unsafe { set(filter, name.as_ptr(), buffer, FLOAT3, width, height, 0, PIXEL_BYTES, 0) };
    }

    fn switch_on(&self, name: &CStr) {
        // SAFETY: a filter and a string that ends with 0.
        unsafe { (self.device.functions.set_filter_bool)(self.handle.as_ptr(), name.as_ptr(), true) };
    }

    /// Does it all and waits for the end.
    fn execute(&self, doing: &'static str) -> Result<(), DenoiseError> {
        // SAFETY: a filter.
        unsafe { (self.device.functions.commit_filter)(self.handle.as_ptr()) };
        self.device.check(doing)?;
        // SAFETY: a filter whose parameters were accepted.
        unsafe { (self.device.functions.execute_filter)(self.handle.as_ptr()) };
        self.device.check(doing)
    }
}

impl Drop for Filter<'_> {
    fn drop(&mut self) {
        // SAFETY: the handle came from `new_filter` and is released once.
        unsafe { (self.device.functions.release_filter)(self.handle.as_ptr()) };
    }
}

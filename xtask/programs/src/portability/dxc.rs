//! Microsoft's DXC as a library, through its interface `IDxcCompiler3` (`dxcapi.h` of DirectXShaderCompiler).
//!
//! The library is often available where the command is not. Its COM interfaces need no headers: an object's first word is the address
//! of its table of functions.

use std::ffi::{OsStr, c_void};
use std::fs;
use std::mem::ManuallyDrop;
use std::path::Path;
use std::ptr;

use libloading::{Library, Symbol};

/// `GUID`.
#[repr(C)]
struct Id(u32, u16, u16, [u8; 8]);

/// `CLSID_DxcCompiler`.
const COMPILER_CLASS: Id = Id(0x73e2_2d93, 0xe6ce, 0x47f3, [0xb5, 0xbf, 0xf0, 0x66, 0x4f, 0x39, 0xc1, 0xb0]);
/// `IID_IDxcCompiler3`.
const COMPILER: Id = Id(0x228b_4687, 0x5a6a, 0x4730, [0x90, 0x0c, 0x97, 0x02, 0xb2, 0x20, 0x3f, 0x54]);
/// `IID_IDxcOperationResult`.
const OUTCOME: Id = Id(0x5834_6cda, 0xdde7, 0x4497, [0x94, 0x61, 0x6f, 0x87, 0xaf, 0x5e, 0x06, 0x59]);

/// `DxcBuffer`.
#[repr(C)]
struct Buffer {
    bytes: *const c_void,
    size: usize,
    encoding: u32,
}

/// `DXC_CP_UTF8`.
const UTF8: u32 = 65001;

/// COM object.
type Object = *mut c_void;

type CreateInstance = unsafe extern "C" fn(*const Id, *const Id, *mut Object) -> i32;
type Compile =
    unsafe extern "C" fn(Object, *const Buffer, *const *const Wide, u32, Object, *const Id, *mut Object) -> i32;
type Status = unsafe extern "C" fn(Object, *mut i32) -> i32;
type Errors = unsafe extern "C" fn(Object, *mut Object) -> i32;
type Bytes = unsafe extern "C" fn(Object) -> *const u8;
type Size = unsafe extern "C" fn(Object) -> usize;

/// Type `wchar_t`, 32 bits on Linux.
type Wide = u32;

/// Indices in the tables of functions; each table begins with the three functions of `IUnknown`.
mod place {
    pub const COMPILE: usize = 3;
    pub const STATUS: usize = 3;
    pub const ERRORS: usize = 5;
    pub const BYTES: usize = 3;
    pub const SIZE: usize = 4;
}

/// Compiles an HLSL file to DXIL, which is dropped. Returns DXC's messages if it fails. If DXC aborts, so does this process.
///
/// # Errors
/// If the library or the file cannot be read, or DXC cannot be called.
pub fn compile(library: &OsStr, file: &Path, entry: &str, profile: &str) -> Result<Option<String>, String> {
    let text = fs::read(file).map_err(|error| format!("{}: {error}", file.display()))?;
    // Without the validator, which the library lacks. The language version is wgpu's.
    let options = ["-E", entry, "-T", profile, "-HV", "2018", "-Vd"].map(wide);
    let options = options.each_ref().map(|option| option.as_ptr());
    compile_text(library, &text, &options)
}

fn wide(word: &str) -> Vec<Wide> {
    word.chars().map(Wide::from).chain([0]).collect()
}

#[allow(unsafe_code)]
fn compile_text(library: &OsStr, text: &[u8], options: &[*const Wide]) -> Result<Option<String>, String> {
    // SAFETY: the library is DXC's, whose constructors have no conditions; function types are those of `dxcapi.h`, with the
    // calling convention of its `WinAdapter.h` on Linux; all pointers outlive the calls. Objects live until the process ends.
    unsafe {
        // The library stays loaded, because it has exit handlers.
        let library = ManuallyDrop::new(Library::new(library).map_err(|error| error.to_string())?);
        let create: Symbol<'_, CreateInstance> =
            library.get(b"DxcCreateInstance\0").map_err(|error| error.to_string())?;
        let mut compiler = ptr::null_mut();
        let failed = create(&COMPILER_CLASS, &COMPILER, &mut compiler);
        if failed != 0 || compiler.is_null() {
            return Err(format!("DXC has no IDxcCompiler3: {failed:#x}"));
        }
        let source = Buffer { bytes: text.as_ptr().cast(), size: text.len(), encoding: UTF8 };
        let count = u32::try_from(options.len()).expect("a few");
        let mut outcome = ptr::null_mut();
        let compile: Compile = function(compiler, place::COMPILE);
        let failed = compile(compiler, &source, options.as_ptr(), count, ptr::null_mut(), &OUTCOME, &mut outcome);
        if failed != 0 || outcome.is_null() {
            return Err(format!("IDxcCompiler3::Compile: {failed:#x}"));
        }
        let (mut status, mut errors) = (0, ptr::null_mut());
        let get_status: Status = function(outcome, place::STATUS);
        let get_errors: Errors = function(outcome, place::ERRORS);
        get_status(outcome, &mut status);
        get_errors(outcome, &mut errors);
        if status == 0 {
            return Ok(None);
        }
        if errors.is_null() {
            return Ok(Some("no message".to_owned()));
        }
        let (bytes, size): (Bytes, Size) = (function(errors, place::BYTES), function(errors, place::SIZE));
        let message = std::slice::from_raw_parts(bytes(errors), size(errors));
        Ok(Some(String::from_utf8_lossy(message).into_owned()))
    }
}

/// Returns a function of an object's table.
///
/// # Safety
/// The object's table must have a function of this type at that index.
#[allow(unsafe_code)]
unsafe fn function<F: Copy>(object: Object, place: usize) -> F {
    // SAFETY: by the caller; a function's address has the size of a pointer.
    unsafe {
        let table = *object.cast::<*const *const c_void>();
        std::mem::transmute_copy(&*table.add(place))
    }
}

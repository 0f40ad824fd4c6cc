//! Download of a file by the browser.

use std::path::Path;

use wasm_bindgen::JsCast;

/// Downloads bytes as a file named as the last component of `path`; `None` if the browser cannot.
pub fn download(path: &Path, bytes: &[u8]) -> Option<()> {
    let parts = js_sys::Array::of1(&js_sys::Uint8Array::from(bytes));
    let blob = web_sys::Blob::new_with_u8_array_sequence(&parts).ok()?;
    let address = web_sys::Url::create_object_url_with_blob(&blob).ok()?;
    let document = web_sys::window()?.document()?;
    let anchor = document.create_element("a").ok()?.dyn_into::<web_sys::HtmlAnchorElement>().ok()?;
    anchor.set_href(&address);
    anchor.set_download(&path.file_name()?.to_string_lossy());
    anchor.click();
    web_sys::Url::revoke_object_url(&address).ok()
}

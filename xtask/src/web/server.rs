//! Web server for one folder, on the loopback address, which also receives the posts of its pages.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;
use std::thread;

/// Size limit of a post, bytes; a mask has 24 KB.
const MAX_POSTED_BYTES: usize = 1 << 24;

/// Callback with the path and the body of a post.
pub type OnPost = Arc<dyn Fn(&str, Vec<u8>) + Send + Sync>;

/// Server with a port.
pub struct Server {
    listener: TcpListener,
    folders: Folders,
}

/// Folder of the root, and optionally another one with the path below which it is served.
#[derive(Clone)]
struct Folders {
    root: PathBuf,
    mounted: Option<(String, PathBuf)>,
}

impl Server {
    /// Binds `port` of the loopback address, or any port if it is 0.
    ///
    /// # Errors
    /// If the port is taken.
    pub fn new(folder: &Path, port: u16) -> Result<Self, String> {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port))
            .map_err(|error| format!("cannot serve on 127.0.0.1:{port}: {error}"))?;
        Ok(Self { listener, folders: Folders { root: folder.to_owned(), mounted: None } })
    }

    /// Serves another folder, too, below a path such as `a/b/`.
    pub fn mount(&mut self, path: &str, folder: &Path) {
        self.folders.mounted = Some((path.to_owned(), folder.to_owned()));
    }

    /// Returns the server's address.
    ///
    /// # Errors
    /// If the system does not know it.
    pub fn address(&self) -> Result<String, String> {
        let address = self.listener.local_addr().map_err(|error| format!("cannot find the server's port: {error}"))?;
        Ok(format!("http://{address}/"))
    }

    /// Answers requests, each connection on its own thread, until the program ends.
    pub fn run(self, on_post: OnPost) {
        for connection in self.listener.incoming().flatten() {
            let (folders, on_post) = (self.folders.clone(), on_post.clone());
            thread::spawn(move || {
                // A closed connection needs no answer.
                let _ = answer(connection, &folders, &on_post);
            });
        }
    }
}

fn answer(mut connection: TcpStream, folders: &Folders, on_post: &OnPost) -> std::io::Result<()> {
    let mut reader = BufReader::new(connection.try_clone()?);
    let mut line = String::new();
    reader.read_line(&mut line)?;
    let mut words = line.split_whitespace();
    let (Some(method), Some(target)) = (words.next().map(str::to_owned), words.next().map(str::to_owned)) else {
        return respond(&mut connection, "400 Bad Request", "text/plain", b"");
    };
    let mut length = 0;
    loop {
        let mut header = String::new();
        if reader.read_line(&mut header)? == 0 || header.trim().is_empty() {
            break;
        }
        if let Some((name, value)) = header.split_once(':')
            && name.eq_ignore_ascii_case("content-length")
        {
            length = value.trim().parse().unwrap_or(0);
        }
    }
    if method == "POST" {
        let mut body = vec![0; length.min(MAX_POSTED_BYTES)];
        reader.read_exact(&mut body)?;
        on_post(&target, body);
        return respond(&mut connection, "204 No Content", "text/plain", b"");
    }
    let path = target.split(['?', '#']).next().unwrap_or_default();
    match file(folders, path).and_then(|file| Some((kind_of(&file), std::fs::read(&file).ok()?))) {
        Some((kind, bytes)) => respond(&mut connection, "200 OK", kind, &bytes),
        None => respond(&mut connection, "404 Not Found", "text/plain", b"file not found"),
    }
}

/// Returns the file of a path; `None` outside the folders.
fn file(folders: &Folders, path: &str) -> Option<PathBuf> {
    let path = path.trim_start_matches('/');
    let mounted =
        folders.mounted.as_ref().and_then(|(below, folder)| Some((folder, path.strip_prefix(below.as_str())?)));
    let (folder, path) = mounted.unwrap_or((&folders.root, path));
    let path = Path::new(path);
    let is_inside = path.components().all(|part| matches!(part, Component::Normal(_)));
    let file = folder.join(if path.as_os_str().is_empty() { Path::new("index.html") } else { path });
    (is_inside && file.is_file()).then_some(file)
}

/// Returns the media type for a file's extension. Browsers require the right one for programs.
fn kind_of(file: &Path) -> &'static str {
    match file.extension().and_then(|ending| ending.to_str()) {
        Some("html") => "text/html; charset=utf-8",
        Some("css") => "text/css; charset=utf-8",
        Some("js") => "text/javascript; charset=utf-8",
        Some("wasm") => "application/wasm",
        Some("png") => "image/png",
        Some("svg") => "image/svg+xml",
        _ => "application/octet-stream",
    }
}

fn respond(connection: &mut TcpStream, status: &str, kind: &str, bytes: &[u8]) -> std::io::Result<()> {
    let length = bytes.len();
    write!(
        connection,
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {length}\r\nCache-Control: no-store\r\n\
         Connection: close\r\n\r\n"
    )?;
    connection.write_all(bytes)?;
    connection.flush()
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;

    use super::*;

    fn ask(address: &str, request: &str) -> String {
        let host = address.trim_start_matches("http://").trim_end_matches('/');
        let mut connection = TcpStream::connect(host).unwrap();
        connection.write_all(request.as_bytes()).unwrap();
        let mut answer = String::new();
        connection.read_to_string(&mut answer).unwrap();
        answer
    }

    #[test]
    fn a_folder_is_served_and_nothing_beside_it() {
        let folder = std::env::temp_dir().join(format!("antumbra-server-{}", std::process::id()));
        std::fs::create_dir_all(folder.join("page")).unwrap();
        std::fs::write(folder.join("page/index.html"), "the page").unwrap();
        std::fs::write(folder.join("secret"), "not the page").unwrap();
        std::fs::write(folder.join("other"), "another folder's file").unwrap();
        let mut server = Server::new(&folder.join("page"), 0).unwrap();
        server.mount("a/b/", &folder);
        let address = server.address().unwrap();
        let posted = Arc::new(Mutex::new(Vec::new()));
        let kept = posted.clone();
        thread::spawn(move || {
            server.run(Arc::new(move |path, body| kept.lock().unwrap().push((path.to_owned(), body))));
        });
        let page = ask(&address, "GET /?test HTTP/1.1\r\nHost: x\r\n\r\n");
        assert!(page.starts_with("HTTP/1.1 200") && page.contains("text/html") && page.ends_with("the page"), "{page}");
        let other = ask(&address, "GET /a/b/other HTTP/1.1\r\n\r\n");
        assert!(other.starts_with("HTTP/1.1 200") && other.ends_with("another folder's file"), "{other}");
        for path in ["/../secret", "/nothing", "//etc/passwd", "/page/../../secret", "/a/b/../secret", "/a/other"] {
            let answer = ask(&address, &format!("GET {path} HTTP/1.1\r\n\r\n"));
            assert!(answer.starts_with("HTTP/1.1 404"), "{path}: {answer}");
        }
        ask(&address, "POST /mask/3 HTTP/1.1\r\ncontent-length: 4\r\n\r\nabcd");
        assert_eq!(*posted.lock().unwrap(), [("/mask/3".to_owned(), b"abcd".to_vec())]);
        std::fs::remove_dir_all(&folder).unwrap();
    }
}

// Starts the viewer, or says why it cannot and shows pictures instead.
//
// The address chooses what it starts with: ?scene=builtin:street&technique=pcss:fast&against=vsm&show=error. It follows the scene and
// the technique that are chosen later.
// With ?test the page tries itself and posts what it finds; see check.js.

const waiting = document.getElementById("waiting");

/** Shows pictures instead of the viewer, and why. */
function showInstead(why) {
  document.getElementById("why").textContent = why;
  document.getElementById("viewer").hidden = true;
  waiting.hidden = true;
  document.getElementById("instead").hidden = false;
  document.body.classList.add("without");
}

/** What keeps WebGPU from this page; nothing where it works. */
async function lackOfWebGpu() {
  if (!window.isSecureContext) return "browsers offer it only to pages loaded over https or from localhost";
  if (!navigator.gpu) return "this browser does not offer it";
  const adapter = await navigator.gpu.requestAdapter().catch(() => null);
  return adapter ? null : "this browser offers it, but found no suitable graphics adapter";
}

/** Puts a built-in scene and the technique of the image into the address. A quality in the address remains while its technique does. */
function updateAddress(viewer) {
  const [scene, technique] = viewer.settled()?.split(" ") ?? [];
  if (!scene?.startsWith("builtin:")) return;
  const asked = new URLSearchParams(location.search);
  if (asked.get("technique")?.split(":")[0] !== technique) asked.set("technique", technique);
  if (asked.get("scene")?.replace(/^builtin:/, "") !== scene.slice("builtin:".length)) asked.set("scene", scene);
  const search = `?${asked}`;
  if (search !== location.search) history.replaceState(null, "", search);
}

async function start() {
  const asked = new URLSearchParams(location.search);
  const lack = await lackOfWebGpu();
  if (lack) {
    showInstead(lack);
    return;
  }
  const program = await import("./antumbra.js");
  await program.default();
  waiting.textContent = "Starting…";
  const canvas = document.getElementById("viewer");
  const [scene, technique, against, show] =
    ["scene", "technique", "against", "show"].map((name) => asked.get(name) ?? undefined);
  const viewer = await program.Viewer.start(canvas, scene, technique, against, show);
  waiting.hidden = true;
  if (asked.has("test")) (await import("./check.js")).run(program, viewer, canvas);
  else setInterval(updateAddress, 500, viewer);
}

start().catch((error) => {
  if (new URLSearchParams(location.search).has("test")) {
    fetch("/done", { method: "POST", body: `the page does not start: ${error}` });
  }
  // A name in the address that means nothing is the reader's to correct, and no lack of the browser.
  const isName = String(error).startsWith("there is no");
  if (isName) waiting.textContent = String(error);
  else showInstead(`the viewer does not start: ${error}`);
});

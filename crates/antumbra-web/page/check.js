// The page tries itself, for `cargo xtask web --check`: it chooses techniques, moves the light, drops files, draws the masks
// of all cases, and posts each step to whoever served it.

/** How long one step may take, milliseconds: software devices compile slowly. */
const PATIENCE_MS = 120_000;

const post = (path, body) => fetch(path, { method: "POST", body });
const breath = () => new Promise((resolve) => setTimeout(resolve, 50));

/** Waits for the viewer to stand still on what `is` accepts; what it then says of itself. */
async function settled(viewer, what, is) {
  const began = performance.now();
  let last = "";
  while (performance.now() - began < PATIENCE_MS) {
    await breath();
    last = viewer.settled() ?? last;
    if (viewer.settled() && is(last)) {
      await post("/step", `${what}: ${last} (${Math.round(performance.now() - began)} ms)`);
      return;
    }
  }
  throw new Error(`${what}: no image was drawn; last: ${last}`);
}

/** Drops a file on the canvas as a hand does. */
function drop(canvas, name, bytes) {
  const dataTransfer = new DataTransfer();
  dataTransfer.items.add(new File([bytes], name));
  for (const kind of ["dragover", "drop"]) {
    canvas.dispatchEvent(new DragEvent(kind, { dataTransfer, bubbles: true, cancelable: true }));
  }
}

/** What a person would do on the page. */
async function byHand(program, viewer, canvas) {
  await settled(viewer, "first picture", (said) => said.startsWith("builtin:"));
  // By hand those that software draws quickly as they come; masks are of all, at the lowest quality.
  for (const name of ["hard", "pcf"]) {
    viewer.choose(name);
    await settled(viewer, "technique", (said) => said.split(" ")[1] === name && said.split(" ").length === 2);
  }
  viewer.choose("pcss");
  viewer.moveLight(0.2, 0.1, 0);
  await settled(viewer, "light moved", (said) => said.endsWith(" pcss"));
  drop(canvas, "dropped.glb", program.glbOf("builtin:window"));
  await settled(viewer, "file dropped", (said) => said === "dropped.glb pcss");
  drop(canvas, "broken.glb", new Uint8Array([1, 2, 3]));
  await settled(viewer, "broken file dropped", (said) => said.includes("broken.glb"));
}

/** The masks of all cases from one on. */
async function drawMasks(program, from, isAll) {
  const masks = await program.Masks.create();
  await post("/adapter", `${masks.adapter}\n${navigator.userAgent}`);
  // The first scene's cases are one for each technique; the others take software an hour.
  const count = isAll ? masks.count : program.techniqueNames().length;
  for (let index = from; index < count; index++) {
    await post("/begun", String(index));
    const began = performance.now();
    try {
      const mask = await masks.draw(index);
      await post(`/mask/${index}`, mask);
    } catch (error) {
      await post("/step", `REFUSED ${masks.name(index)}: ${error}`);
    }
    const ms = Math.round(performance.now() - began);
    if (index % 10 === 0 || ms > 2000) await post("/step", `mask ${index} of ${count}: ${masks.name(index)} (${ms} ms)`);
  }
}

export async function run(program, viewer, canvas) {
  // A program that panics answers nothing more.
  addEventListener("error", (event) => post("/done", `an error: ${event.message}`));
  try {
    const asked = new URLSearchParams(location.search);
    // Where a browser has ended, the next goes on after the mask that it ended at.
    const from = Number(asked.get("from") ?? 0);
    if (from === 0) await byHand(program, viewer, canvas);
    await drawMasks(program, from, asked.get("test") === "all");
    await post("/done", "");
  } catch (error) {
    await post("/done", String(error));
  }
}

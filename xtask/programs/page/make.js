// Makes every program that `programs.json` describes with this browser's WebGPU, on a device within its default limits, and
// posts what the browser refuses: modules and layouts, and with `?pipelines` in the address pipelines of these, too.

/** Pipelines that are being made at a time: the browser compiles them on threads. */
const AT_ONCE = 4;
/** A pipeline that takes longer has passed the browser's own compiler, and waits for the driver's. */
const PATIENCE_MS = 20_000;

const post = (path, body) => fetch(path, { method: "POST", body });

/** What `make` gives, and what the browser has to say against it. */
async function validated(device, make) {
  device.pushErrorScope("validation");
  let made = null;
  let thrown = null;
  try {
    made = make();
  } catch (error) {
    thrown = String(error);
  }
  const error = await device.popErrorScope();
  return [made, thrown ?? error?.message ?? null];
}

/** The descriptions' modules and layouts, each with its problem. */
async function makeParts(device, programs, refuse) {
  const modules = [];
  for (const { label, code } of programs.modules) {
    const [module, problem] = await validated(device, () => device.createShaderModule({ label, code }));
    const { messages } = await module.getCompilationInfo();
    const said = messages.filter(({ type }) => type === "error").map(({ lineNum, message }) => `line ${lineNum}: ${message}`);
    if (said.length > 0 || problem) refuse(`module ${label}`, said[0] ?? problem);
    modules.push(module);
  }
  const groups = [];
  for (const [index, description] of programs.bindGroupLayouts.entries()) {
    const [layout, problem] = await validated(device, () => device.createBindGroupLayout(description));
    if (problem) refuse(`bind group layout ${index}: ${JSON.stringify(description)}`, problem);
    groups.push(layout);
  }
  const layouts = [];
  for (const [index, { bindGroupLayouts }] of programs.pipelineLayouts.entries()) {
    const of = bindGroupLayouts.map((group) => (group === null ? null : groups[group]));
    const [layout, problem] = await validated(device, () => device.createPipelineLayout({ bindGroupLayouts: of }));
    if (problem) refuse(`pipeline layout ${index}`, problem);
    layouts.push(layout);
  }
  return { modules, layouts };
}

/** A pipeline as it was described, of these modules and layouts. */
function described(pipeline, { modules, layouts }) {
  const whole = { ...pipeline, layout: layouts[pipeline.layout] };
  for (const stage of ["compute", "vertex", "fragment"]) {
    if (pipeline[stage]) whole[stage] = { ...pipeline[stage], module: modules[pipeline[stage].module] };
  }
  return whole;
}

/** What stands in a list of problems for a pipeline. */
function nameOf(pipeline, programs) {
  const stages = ["compute", "vertex", "fragment"].filter((stage) => pipeline[stage]).map((stage) => {
    const { module, entryPoint, constants } = pipeline[stage];
    return `${stage} ${entryPoint ?? ""} of ${programs.modules[module].label} ${JSON.stringify(constants)}`;
  });
  return `pipeline ${pipeline.label}: ${stages.join(", ")}`;
}

async function makePipelines(device, programs, parts, refuse) {
  const slow = [];
  let next = 0;
  let done = 0;
  const worker = async () => {
    while (next < programs.pipelines.length) {
      const pipeline = programs.pipelines[next++];
      const began = performance.now();
      const whole = described(pipeline, parts);
      const making = (async () => {
        await (pipeline.compute ? device.createComputePipelineAsync(whole) : device.createRenderPipelineAsync(whole));
      })().catch((error) => refuse(nameOf(pipeline, programs), String(error.message ?? error)));
      const patience = new Promise((resolve) => setTimeout(resolve, PATIENCE_MS, "slow"));
      if ((await Promise.race([making, patience])) === "slow") slow.push(nameOf(pipeline, programs));
      const ms = Math.round(performance.now() - began);
      if (ms > 2000) await post("/step", `${ms} ms: ${nameOf(pipeline, programs)}`);
      if (++done % 50 === 0) await post("/step", `${done} of ${programs.pipelines.length} pipelines`);
    }
  };
  await Promise.all(Array.from({ length: AT_ONCE }, worker));
  return slow;
}

async function run() {
  const adapter = await navigator.gpu?.requestAdapter();
  if (!adapter) throw new Error("the browser has no adapter");
  const programs = await (await fetch("programs.json")).json();
  const wanted = ["depth-clip-control", "timestamp-query"];
  const device = await adapter.requestDevice({ requiredFeatures: wanted.filter((name) => adapter.features.has(name)) });
  const refused = [];
  const refuse = (what, why) => refused.push(`${what}: ${why}`);
  device.addEventListener("uncapturederror", ({ error }) => refuse("the device", error.message));
  device.lost.then(({ message }) => post("/done", `the device is lost: ${message}`));
  const { vendor, architecture, description } = adapter.info;
  await post("/adapter", `${vendor} ${architecture} ${description}; ${navigator.userAgent}`);
  const parts = await makeParts(device, programs, refuse);
  await post("/step", `${parts.modules.length} modules and ${parts.layouts.length} layouts made`);
  // Pipelines of what was refused would be refused for it alone.
  const wantsPipelines = location.search === "?pipelines" && refused.length === 0;
  const slow = wantsPipelines ? await makePipelines(device, programs, parts, refuse) : [];
  for (const name of slow) await post("/step", `SLOW, taken by the browser's compiler alone: ${name}`);
  await post("/done", refused.length === 0 ? "" : `${refused.length} refused:\n${refused.slice(0, 20).join("\n")}`);
}

addEventListener("error", ({ message }) => post("/done", `an error: ${message}`));
run().catch((error) => post("/done", String(error)));

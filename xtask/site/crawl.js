// Opens every page of the site in a frame as wide as a small screen, and posts its faults to the server: `cargo xtask site --check`.

const WIDTH_PX = 400;
/** Longest time to the first image of a page, milliseconds. */
const FIRST_IMAGE_MS = 2000;
/** Longest time until the viewer shows an image: software compiles its shaders. */
const VIEWER_MS = 300_000;

const site = new URL(location.search.slice(1), location.origin);
const post = (path, body) => fetch(path, { method: "POST", body });
const fault = (page, what) => post("/fault", `${page.slice(site.href.length)}: ${what}`);
const pause = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

/** Page of an address: without the part behind # or ?. */
const pageOf = (address) => address.split(/[?#]/)[0];

const frame = document.createElement("iframe");

/** Opens a page; milliseconds to its first image, or null where it has none. */
async function open(address) {
  frame.remove();
  const began = performance.now();
  const loaded = new Promise((resolve) => frame.addEventListener("load", resolve, { once: true }));
  let isLoaded = false;
  loaded.then(() => { isLoaded = true; });
  frame.src = address;
  document.body.append(frame);
  // Icons that are part of the address of an image need no fetch.
  const isShown = (image) => image.complete && image.naturalWidth > 0 && !image.src.startsWith("data:");
  const isOpen = () => frame.contentDocument?.URL.split("#")[0] === address.split("#")[0];
  let first = null;
  while (!isLoaded || first === null) {
    // The book's page for printing opens a dialog when it has loaded.
    if (isOpen()) frame.contentWindow.print = () => {};
    const images = isOpen() ? [...frame.contentDocument.images].filter((image) => !image.src.startsWith("data:")) : [];
    if (first === null && images.some(isShown)) first = performance.now() - began;
    if (isLoaded && (images.length === 0 || performance.now() - began > 2 * FIRST_IMAGE_MS)) break;
    await pause(5);
  }
  await loaded;
  return first;
}

/** Addresses in the open page: of links, and of what it loads. */
function addresses(page) {
  const of = (selector, attribute) =>
    [...page.querySelectorAll(selector)].map((element) => new URL(element.getAttribute(attribute), page.baseURI).href);
  const sets = [...page.querySelectorAll("[srcset]")].flatMap((element) => element.srcset.split(","));
  return {
    links: of("a[href]", "href"),
    resources: [
      ...of("[src]", "src"), ...of("link[href]", "href"),
      ...sets.map((entry) => new URL(entry.trim().split(" ")[0], page.baseURI).href),
      ...frame.contentWindow.performance.getEntriesByType("resource").map((entry) => entry.name),
    ].filter((address) => !address.startsWith("data:")),
  };
}

/** Crawls from the index; what was found of each page, by its address. */
async function crawl() {
  const pages = new Map();
  const queue = [new URL("index.html", site).href];
  for (const address of queue) {
    const first = await open(address);
    const page = frame.contentDocument;
    const ids = new Set([...page.querySelectorAll("[id], a[name]")].flatMap((element) => [element.id, element.name]));
    pages.set(address, { ids, first, ...addresses(page) });
    if (first !== null && first > FIRST_IMAGE_MS) await fault(address, `first image after ${Math.round(first)} ms`);
    for (const image of page.images) if (!image.hasAttribute("alt")) await fault(address, `no alt text: ${image.src}`);
    const width = page.documentElement.scrollWidth;
    if (width > WIDTH_PX) await fault(address, `${width} px wide on a screen of ${WIDTH_PX} px`);
    for (const link of pages.get(address).links.map(pageOf)) {
      if (link.startsWith(site.href) && link.endsWith(".html") && !queue.includes(link)) queue.push(link);
    }
  }
  return pages;
}

/** Faults in links of the crawled pages. Of other sites' addresses nothing is fetched. */
async function followLinks(pages) {
  const fetched = new Map();
  const counts = { links: 0, anchors: 0, outside: new Set() };
  for (const [address, page] of pages) {
    for (const link of new Set([...page.links, ...page.resources])) {
      if (!link.startsWith(site.href)) {
        const isLoaded = page.resources.includes(link);
        if (isLoaded || link.startsWith(location.origin)) await fault(address, `outside of the site: ${link}`);
        else counts.outside.add(link);
        continue;
      }
      counts.links += 1;
      const target = pageOf(link);
      if (!fetched.has(target)) fetched.set(target, (await fetch(target)).ok);
      if (!fetched.get(target)) await fault(address, `leads nowhere: ${link}`);
      const anchor = decodeURIComponent(new URL(link).hash.slice(1));
      if (anchor === "") continue;
      counts.anchors += 1;
      if (!pages.get(target)?.ids.has(anchor)) await fault(address, `no such anchor: ${link}`);
    }
  }
  return counts;
}

/** Has the viewer's program read what links to it ask for, and opens one. */
async function tryViewer(pages) {
  const home = new URL("viewer/index.html", site).href;
  const links = new Set([...pages.values()].flatMap((page) => page.links).filter((link) => link.startsWith(`${home}?`)));
  const program = await import(new URL("viewer/antumbra.js", site));
  await program.default();
  const techniques = new Set(program.techniqueNames());
  const scenes = new Set();
  for (const link of links) {
    const asked = new URL(link).searchParams;
    const [scene, technique] = [asked.get("scene"), asked.get("technique")];
    if (!techniques.has(technique)) await fault(link, "no such technique");
    if (scenes.has(scene)) continue;
    scenes.add(scene);
    try {
      program.glbOf(`builtin:${scene}`);
    } catch (error) {
      await fault(link, String(error));
    }
    await post("/step", `viewer reads ${scene}`);
  }
  const [link] = links;
  const began = performance.now();
  await open(link);
  const isShown = () => frame.contentDocument.getElementById("waiting").hidden;
  while (!isShown() && performance.now() - began < VIEWER_MS) await pause(50);
  const page = frame.contentDocument;
  if (!isShown() || !page.getElementById("instead").hidden) {
    await fault(link, `no viewer: ${page.body.innerText.slice(0, 200)}`);
  }
  return { addresses: links.size, scenes: scenes.size, techniques: techniques.size, ms: performance.now() - began };
}

async function run() {
  const pages = await crawl();
  const firsts = [...pages].filter(([, page]) => page.first !== null).sort((a, b) => b[1].first - a[1].first);
  const index = pages.get(new URL("index.html", site).href);
  const [slowest] = firsts;
  await post("/step", `${pages.size} pages, ${firsts.length} with images; first image of the index after ${Math.round(index.first)} ms, ` +
    `latest after ${Math.round(slowest[1].first)} ms on ${slowest[0].slice(site.href.length)}`);
  const counts = await followLinks(pages);
  await post("/step", `${counts.links} links and resources, ${counts.anchors} anchors; not followed: ${[...counts.outside].join(" ")}`);
  const viewer = await tryViewer(pages);
  await post("/step", `${viewer.addresses} addresses of the viewer: ${viewer.scenes} scenes × ${viewer.techniques} techniques; ` +
    `one opened in ${Math.round(viewer.ms)} ms`);
  await post("/done", "");
}

run().catch((error) => post("/done", `the crawl fails: ${error.stack}`));

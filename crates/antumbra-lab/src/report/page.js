// The report's page: the two-image viewer, the large view, the sortable table. No libraries, no network.
"use strict";
(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const kindNames = { shaded: "shaded", visibility: "visibility", error: "error" };
  const nameOf = (image) => `${data.groups[image.group].name} · ${kindNames[image.kind]}`;
  const findImage = (group, kind) =>
    data.images.find((image) => image.group === group && image.kind === kind)
    || data.images.find((image) => image.group === group && image.kind === "visibility");
  const clamp = (v, low, high) => Math.min(Math.max(v, low), high);

  // Visibility for the pixel readout. Pixels of an image file cannot be read by a page that was opened from disk, so
  // they come as data URIs in a script of their own, fetched when somebody first points at an image.
  const values = (() => {
    let isAsked = false;
    const listeners = [];
    const decode = (uri) => new Promise((resolve, reject) => {
      const image = new Image();
      image.onload = () => {
        const canvas = document.createElement("canvas");
        canvas.width = data.width;
        canvas.height = data.height;
        const context = canvas.getContext("2d", { willReadFrequently: true });
        context.drawImage(image, 0, 0);
        resolve(context.getImageData(0, 0, data.width, data.height).data);
      };
      image.onerror = reject;
      image.src = uri;
    });
    const planes = new Map();
    const plane = (key, uri) => {
      if (!planes.has(key)) {
        planes.set(key, null);
        decode(uri).then((pixels) => {
          planes.set(key, pixels);
          for (const listener of listeners) listener();
        }, () => {});
      }
      return planes.get(key);
    };
    const load = () => {
      if (isAsked) return;
      isAsked = true;
      const script = document.createElement("script");
      script.src = "values.js";
      script.onload = () => { for (const listener of listeners) listener(); };
      document.head.append(script);
    };
    return {
      load,
      onReady(listener) { listeners.push(listener); },
      at(group, x, y) {
        const loaded = window.antumbraValues;
        const pixels = loaded && plane(group, loaded.visibility[group]);
        if (!pixels) return null;
        const i = 4 * (y * data.width + x);
        return [pixels[i] / 255, pixels[i + 1] / 255, pixels[i + 2] / 255];
      },
      isJudged(x, y) {
        const loaded = window.antumbraValues;
        const pixels = loaded && loaded.judged && plane("judged", loaded.judged);
        return pixels ? pixels[4 * (y * data.width + x)] > 127 : true;
      },
    };
  })();

  const triple = (v) => {
    const texts = v.map((c) => c.toFixed(2));
    return v[0] === v[1] && v[1] === v[2] ? texts[0] : `(${texts.join(", ")})`;
  };
  const signed = (v, ref) => {
    const errors = v.map((c, i) => c - ref[i]);
    const worst = errors.reduce((a, b) => (Math.abs(b) > Math.abs(a) ? b : a));
    return `${worst < 0 ? "−" : "+"}${Math.abs(worst).toFixed(2)}`;
  };

  // A stage that shows one image, or two with a divider, at one zoom and position.
  class Viewer {
    constructor(root, { isSplit, wheelNeedsCtrl }) {
      this.root = root;
      this.stage = this.part("stage");
      this.readout = this.part("readout");
      this.isSplit = isSplit;
      this.wheelNeedsCtrl = wheelNeedsCtrl;
      this.scale = 0; // 0 stands for: fitted
      this.x = 0;
      this.y = 0;
      this.split = 0.5;
      this.images = [];
      this.pointers = new Map();
      this.build();
      this.listen();
    }

    part(role) { return this.root.querySelector(`[data-role="${role}"]`); }

    build() {
      this.stage.replaceChildren();
      this.stage.tabIndex = 0;
      this.stage.setAttribute("role", "group");
      this.layers = Array.from({ length: this.isSplit ? 2 : 1 }, () => {
        const layer = document.createElement("div");
        layer.className = "layer";
        const img = document.createElement("img");
        img.width = data.width;
        img.height = data.height;
        layer.append(img);
        this.stage.append(layer);
        return { layer, img };
      });
      this.pixel = document.createElement("div");
      this.pixel.className = "pixel";
      this.stage.append(this.pixel);
      if (!this.isSplit) return;
      this.tags = ["left", "right"].map((side) => {
        const tag = document.createElement("div");
        tag.className = `tag ${side}`;
        this.stage.append(tag);
        return tag;
      });
      this.divider = document.createElement("div");
      this.divider.className = "divider";
      this.divider.tabIndex = 0;
      this.divider.setAttribute("role", "slider");
      this.divider.setAttribute("aria-label", "Divider between the left and the right image");
      this.divider.setAttribute("aria-valuemin", "0");
      this.divider.setAttribute("aria-valuemax", "100");
      this.stage.append(this.divider);
    }

    show(images) {
      this.images = images;
      images.forEach((image, i) => {
        const { img } = this.layers[i];
        if (img.getAttribute("src") !== image.src) img.src = image.src;
        img.alt = nameOf(image);
        if (this.tags) this.tags[i].textContent = nameOf(image);
      });
      this.stage.setAttribute("aria-label", images.map(nameOf).join(" against "));
      this.draw();
      this.read();
    }

    get fitScale() {
      const { clientWidth: w, clientHeight: h } = this.stage;
      return Math.min(w / data.width, h / data.height) || 1;
    }

    draw() {
      const { clientWidth: w, clientHeight: h } = this.stage;
      const fit = this.fitScale;
      const scale = Math.max(this.scale, fit);
      const place = (offset, room, length) =>
        length <= room ? (room - length) / 2 : clamp(offset, room - length, 0);
      this.x = place(this.x, w, data.width * scale);
      this.y = place(this.y, h, data.height * scale);
      for (const { img } of this.layers) img.style.transform = `translate(${this.x}px, ${this.y}px) scale(${scale})`;
      this.drawnScale = scale;
      this.stage.classList.toggle("zoomed", scale > fit * 1.001);
      this.stage.classList.toggle("pixels", scale >= 2);
      if (this.isSplit) {
        const percent = 100 * this.split;
        this.layers[1].layer.style.clipPath = `inset(0 0 0 ${percent}%)`;
        this.divider.style.left = `${percent}%`;
        this.divider.setAttribute("aria-valuenow", percent.toFixed(0));
      }
      const label = this.part("fit");
      if (label) label.textContent = this.scale === 0 || scale <= fit ? "Fit" : `${scale >= 10 ? scale.toFixed(0) : scale.toFixed(1)}×`;
    }

    zoomTo(scale, atX = this.stage.clientWidth / 2, atY = this.stage.clientHeight / 2) {
      const before = this.drawnScale || this.fitScale;
      const after = clamp(scale, this.fitScale, 64);
      this.x = atX - (atX - this.x) * after / before;
      this.y = atY - (atY - this.y) * after / before;
      this.scale = after <= this.fitScale * 1.001 ? 0 : after;
      this.draw();
      this.read();
    }

    zoomBy(factor, atX, atY) { this.zoomTo((this.drawnScale || this.fitScale) * factor, atX, atY); }

    at(event) {
      const box = this.stage.getBoundingClientRect();
      return [event.clientX - box.left, event.clientY - box.top];
    }

    setSplit(split) {
      this.split = clamp(split, 0, 1);
      this.draw();
    }

    listen() {
      const { stage } = this;
      const click = (role, action) => this.part(role)?.addEventListener("click", action);
      click("in", () => this.zoomBy(2));
      click("out", () => this.zoomBy(0.5));
      click("fit", () => this.zoomTo(0));

      stage.addEventListener("wheel", (event) => {
        if (this.wheelNeedsCtrl && !event.ctrlKey && !event.metaKey) return;
        event.preventDefault();
        this.zoomBy(Math.exp(-event.deltaY * (event.deltaMode === 1 ? 0.05 : 0.002)), ...this.at(event));
      }, { passive: false });
      stage.addEventListener("dblclick", (event) => {
        if (event.target === this.divider) return;
        this.zoomTo(this.scale === 0 ? Math.max(4, this.fitScale * 4) : 0, ...this.at(event));
      });
      stage.addEventListener("keydown", (event) => this.onKey(event));

      stage.addEventListener("pointerdown", (event) => {
        if (event.button !== 0) return;
        this.pointers.set(event.pointerId, this.at(event));
        this.drag = this.isSplit && (event.target === this.divider || !stage.classList.contains("zoomed")) ? "split" : "pan";
        if (event.pointerType !== "touch" || event.target === this.divider || this.drag === "pan") {
          stage.setPointerCapture(event.pointerId);
        }
        if (this.drag === "pan") stage.classList.add("panning");
        if (this.drag === "split" && event.pointerType === "mouse") this.setSplit(this.at(event)[0] / stage.clientWidth);
      });
      stage.addEventListener("pointermove", (event) => {
        values.load();
        const now = this.at(event);
        const before = this.pointers.get(event.pointerId);
        if (before) {
          const others = [...this.pointers.entries()].filter(([id]) => id !== event.pointerId).map(([, at]) => at);
          this.pointers.set(event.pointerId, now);
          if (others.length > 0) {
            const spread = (at) => Math.hypot(at[0] - others[0][0], at[1] - others[0][1]) || 1;
            this.zoomBy(spread(now) / spread(before), (now[0] + others[0][0]) / 2, (now[1] + others[0][1]) / 2);
          } else if (this.drag === "split") {
            this.setSplit(now[0] / stage.clientWidth);
          } else {
            this.x += now[0] - before[0];
            this.y += now[1] - before[1];
            this.draw();
          }
        }
        this.read(now);
      });
      const release = (event) => {
        this.pointers.delete(event.pointerId);
        stage.classList.remove("panning");
      };
      stage.addEventListener("pointerup", release);
      stage.addEventListener("pointercancel", release);
      stage.addEventListener("pointerleave", () => { this.pixel.style.display = "none"; });
      new ResizeObserver(() => this.draw()).observe(stage);
      values.onReady(() => this.read());
    }

    onKey(event) {
      const step = event.shiftKey ? 0.1 : 0.01;
      const actions = {
        "+": () => this.zoomBy(2), "=": () => this.zoomBy(2), "-": () => this.zoomBy(0.5), "0": () => this.zoomTo(0),
      };
      if (this.isSplit) {
        actions.ArrowLeft = () => this.setSplit(this.split - step);
        actions.ArrowRight = () => this.setSplit(this.split + step);
        actions.Home = () => this.setSplit(0);
        actions.End = () => this.setSplit(1);
      }
      const action = !event.ctrlKey && !event.metaKey && actions[event.key];
      if (!action) return;
      event.preventDefault();
      action();
    }

    // Says what stands under the pointer, in the truth and in both images.
    read(at = this.lastAt) {
      if (!at) return;
      this.lastAt = at;
      const px = Math.floor((at[0] - this.x) / this.drawnScale);
      const py = Math.floor((at[1] - this.y) / this.drawnScale);
      if (px < 0 || py < 0 || px >= data.width || py >= data.height) return;
      const isLarge = this.drawnScale >= 6;
      Object.assign(this.pixel.style, {
        display: isLarge ? "block" : "none", left: `${this.x + px * this.drawnScale}px`, top: `${this.y + py * this.drawnScale}px`,
        width: `${this.drawnScale}px`, height: `${this.drawnScale}px`,
      });
      const parts = [["Pixel", `${px}, ${py}`]];
      const truth = values.at(0, px, py);
      if (truth) {
        parts.push(["V_ref", triple(truth), truth]);
        for (const group of new Set(this.images.map((image) => image.group))) {
          const v = group > 0 && values.at(group, px, py);
          if (v) parts.push([`V ${data.groups[group].name}`, `${triple(v)} (${signed(v, truth)})`, v]);
        }
        if (!values.isJudged(px, py)) parts.push(["", "not judged"]);
      }
      this.readout.replaceChildren(...parts.map(([label, value, color]) => {
        const span = document.createElement("span");
        if (color) {
          const swatch = document.createElement("i");
          swatch.style.background = `rgb(${color.map((c) => Math.round(255 * c)).join(" ")})`;
          span.append(swatch);
        }
        const strong = document.createElement("b");
        strong.textContent = value;
        span.append(label ? `${label} ` : "", strong);
        return span;
      }));
    }
  }

  // The two-image viewer.
  const compareRoot = document.getElementById("compare");
  const compare = new Viewer(compareRoot, { isSplit: true, wheelNeedsCtrl: true });
  const selects = ["left", "right"].map((role) => compare.part(role));
  for (const select of selects) {
    data.groups.forEach((group, g) => {
      const options = document.createElement("optgroup");
      options.label = group.name;
      data.images.forEach((image, i) => {
        if (image.group === g) options.append(new Option(nameOf(image), String(i)));
      });
      select.append(options);
    });
    select.addEventListener("change", () => update());
  }
  const kindButtons = [...compareRoot.querySelectorAll("[data-kind]")];
  const shown = () => selects.map((select) => data.images[Number(select.value)]);
  const update = () => {
    const images = shown();
    compare.show(images);
    for (const button of kindButtons) {
      const kind = button.dataset.kind;
      button.setAttribute("aria-pressed", String(images.every((image) => image === findImage(image.group, kind))));
    }
  };
  for (const button of kindButtons) {
    button.addEventListener("click", () => {
      shown().forEach((image, i) => {
        selects[i].value = String(data.images.indexOf(findImage(image.group, button.dataset.kind)));
      });
      update();
    });
  }
  compare.part("swap").addEventListener("click", () => {
    [selects[0].value, selects[1].value] = [selects[1].value, selects[0].value];
    update();
  });
  selects[0].value = String(data.images.indexOf(findImage(0, "shaded")));
  selects[1].value = String(data.images.indexOf(findImage(Math.min(1, data.groups.length - 1), "shaded")));
  update();

  // The large view.
  const dialog = document.getElementById("lightbox");
  const large = new Viewer(dialog, { isSplit: false, wheelNeedsCtrl: false });
  let current = 0;
  const caption = large.part("caption");
  const showLarge = (i) => {
    current = (i + data.images.length) % data.images.length;
    const image = data.images[current];
    const title = document.createElement("small");
    title.textContent = ` ${data.groups[image.group].title} · ${current + 1} of ${data.images.length}`;
    caption.replaceChildren(nameOf(image), title);
    large.show([image]);
  };
  const stepGroup = (step) => {
    const { group, kind } = data.images[current];
    const count = data.groups.length;
    for (let g = (group + step + count) % count; ; g = (g + step + count) % count) {
      const i = data.images.findIndex((image) => image.group === g && image.kind === kind);
      if (i >= 0) return showLarge(i);
    }
  };
  for (const shot of document.querySelectorAll("a.shot[data-image]")) {
    shot.addEventListener("click", (event) => {
      if (event.ctrlKey || event.metaKey || event.shiftKey) return;
      event.preventDefault();
      dialog.showModal();
      large.zoomTo(0);
      showLarge(data.images.findIndex((image) => image.src === shot.dataset.image));
      large.stage.focus();
    });
  }
  large.part("previous").addEventListener("click", () => showLarge(current - 1));
  large.part("next").addEventListener("click", () => showLarge(current + 1));
  large.part("close").addEventListener("click", () => dialog.close());
  dialog.addEventListener("keydown", (event) => {
    const actions = {
      ArrowLeft: () => showLarge(current - 1), ArrowRight: () => showLarge(current + 1),
      ArrowUp: () => stepGroup(-1), ArrowDown: () => stepGroup(1),
    };
    if (!actions[event.key]) return;
    event.preventDefault();
    actions[event.key]();
  });

  // The table: headings become buttons; rows without numbers stay where they are.
  const table = document.getElementById("table");
  const tip = document.getElementById("tip");
  for (const [column, th] of [...table.querySelectorAll("thead th")].entries()) {
    const button = document.createElement("button");
    button.type = "button";
    button.className = "sort";
    button.textContent = th.textContent;
    th.replaceChildren(button);
    button.addEventListener("click", () => {
      const isHigherBetter = (th.dataset.direction || "").startsWith("higher");
      const first = isHigherBetter ? "descending" : "ascending";
      const order = th.getAttribute("aria-sort") === first ? (first === "ascending" ? "descending" : "ascending") : first;
      for (const other of table.querySelectorAll("th[aria-sort]")) other.removeAttribute("aria-sort");
      th.setAttribute("aria-sort", order);
      const body = table.tBodies[0];
      const skipped = body.querySelector("tr.skipped");
      const sign = order === "ascending" ? 1 : -1;
      const key = (row) => {
        const cell = row.cells[column];
        if (column === 0) return cell.textContent;
        return cell.dataset.value === "" ? NaN : Number(cell.dataset.value);
      };
      [...body.querySelectorAll("tr:not(.truth):not(.skipped)")]
        .sort((a, b) => {
          const [u, v] = [key(a), key(b)];
          if (column === 0) return sign * u.localeCompare(v);
          if (Number.isNaN(u) || Number.isNaN(v)) return Number.isNaN(u) - Number.isNaN(v);
          return sign * (u - v);
        })
        .forEach((row) => body.insertBefore(row, skipped));
    });
    if (!th.dataset.meaning) continue;
    th.removeAttribute("title");
    const show = () => {
      const direction = document.createElement("em");
      direction.textContent = th.dataset.direction;
      tip.replaceChildren(th.dataset.meaning, direction);
      tip.hidden = false;
      const box = th.getBoundingClientRect();
      tip.style.left = `${clamp(box.left, 8, window.innerWidth - tip.offsetWidth - 8)}px`;
      const below = box.bottom + 8;
      tip.style.top = `${below + tip.offsetHeight < window.innerHeight ? below : box.top - tip.offsetHeight - 8}px`;
    };
    const hide = () => { tip.hidden = true; };
    button.setAttribute("aria-describedby", "tip");
    th.addEventListener("pointerenter", show);
    th.addEventListener("pointerleave", hide);
    button.addEventListener("focus", show);
    button.addEventListener("blur", hide);
    button.addEventListener("keydown", (event) => { if (event.key === "Escape") hide(); });
  }

  // Bars: to scale, or each row in full.
  const scatters = document.getElementById("scatters");
  const [error, cost] = scatters ? scatters.querySelectorAll("select") : [];
  const showScatter = () => {
    for (const drawing of scatters.querySelectorAll("[data-error]")) {
      drawing.hidden = drawing.dataset.error !== error.value || drawing.dataset.cost !== cost.value;
    }
  };
  for (const choice of [error, cost]) choice?.addEventListener("change", showScatter);

  const bars = document.getElementById("bars");
  for (const button of bars ? bars.querySelectorAll("[data-lengths]") : []) {
    button.addEventListener("click", () => {
      bars.classList.toggle("full", button.dataset.lengths === "full");
      for (const other of bars.querySelectorAll("[data-lengths]")) other.setAttribute("aria-pressed", String(other === button));
    });
  }
})();

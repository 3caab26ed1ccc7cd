// The toolbar, the keys and the address bar: they change the one view that all viewers share.

const element = (id) => document.getElementById(id);
const toolbar = document.querySelector(".toolbar");
const names = [...element("show").options].map((option) => option.textContent.replace(/^\d+ /, ""));
const defaults = { ...view };
const viewers = [...document.querySelectorAll("article:has(canvas)")].map((article) => new Viewer(article, names, changed));

/** Bring everything into line with `view`; drawing waits for the next frame, so that a drag stays smooth. */
let drawing = false;
function changed() {
  const margin = 0.5 / view.zoom;
  for (const axis of ["x", "y"]) view[axis] = Math.min(1 - margin, Math.max(margin, view[axis]));
  toolbar.dataset.mode = view.mode;
  toolbar.querySelector(`[name="mode"][value="${view.mode}"]`).checked = true;
  for (const id of ["show", "against", "split", "exposure"]) element(id).value = view[id];
  element("exposure-value").textContent = `${view.exposure > 0 ? "+" : ""}${view.exposure}`;
  element("zoom-value").textContent = `${Math.round(100 * view.zoom)} %`;
  for (const button of document.querySelectorAll("[data-show]")) {
    button.setAttribute("aria-pressed", String(Number(button.dataset.show) === view.show));
  }
  if (drawing) return;
  drawing = true;
  requestAnimationFrame(() => {
    drawing = false;
    viewers.forEach((viewer) => viewer.draw());
    remember();
  });
}

/** Keep in the address what differs from the start, so that a view can be sent to someone. */
let remembering = 0;
function remember() {
  clearTimeout(remembering);
  remembering = setTimeout(() => {
    const different = Object.keys(view).filter((name) => view[name] !== defaults[name]);
    const shorter = (value) => (typeof value === "number" ? Number(value.toFixed(4)) : value);
    const parts = different.map((name) => `${name}=${shorter(view[name])}`);
    if (parts.length > 0 || location.hash.includes("=")) history.replaceState(null, "", `#${parts.join("&")}`);
  }, 200);
}

const ranges = { show: [0, names.length - 1], against: [0, names.length - 1], split: [0, 1], exposure: [-8, 8], zoom: [1, MOST_ZOOM], x: [0, 1], y: [0, 1] };

/** Take over what the address asks for, as far as it makes sense. */
function recall() {
  const asked = new URLSearchParams(location.hash.slice(1));
  for (const [name, [least, most]] of Object.entries(ranges)) {
    const value = Number(asked.get(name) ?? NaN);
    if (value >= least && value <= most) view[name] = value;
  }
  view.show = Math.round(view.show);
  view.against = Math.round(view.against);
  if (["picture", "wipe", "difference", "flip"].includes(asked.get("mode"))) view.mode = asked.get("mode");
}

function set(name, value) {
  view[name] = value;
  changed();
}

/** Wipe and difference need two pictures. */
function choose(mode) {
  if ((mode === "wipe" || mode === "difference") && view.show === view.against) view.show = view.against === 0 ? 1 : 0;
  set("mode", mode);
}

function expose(stops) {
  set("exposure", Math.min(8, Math.max(-8, view.exposure + stops)));
}

function zoom(factor) {
  view.zoom = Math.min(MOST_ZOOM, Math.max(1, view.zoom * factor));
  changed();
}

function reset() {
  Object.assign(view, { exposure: 0, zoom: 1, x: 0.5, y: 0.5 });
  changed();
}

function switchTheme() {
  const root = document.documentElement;
  const dark = root.dataset.theme ? root.dataset.theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
  root.dataset.theme = dark ? "light" : "dark";
}

const keys = {
  p: () => choose("picture"),
  w: () => choose("wipe"),
  d: () => choose("difference"),
  f: () => choose("flip"),
  e: () => expose(0.5),
  E: () => expose(-0.5),
  "+": () => zoom(1.5),
  "=": () => zoom(1.5),
  "-": () => zoom(1 / 1.5),
  r: reset,
  t: switchTheme,
  "?": () => element("keys").showModal(),
  ArrowRight: () => set("show", (view.show + 1) % names.length),
  ArrowLeft: () => set("show", (view.show + names.length - 1) % names.length),
};

function pressed(event) {
  const busy = event.target.closest("select, input, dialog");
  if (event.ctrlKey || event.metaKey || event.altKey || (busy && !/^(Digit|Numpad)\d$/.test(event.code))) return;
  // By place on the keyboard, because Shift changes what a digit key writes.
  const digit = /^(?:Digit|Numpad)(\d)$/.exec(event.code);
  if (digit) {
    if (Number(digit[1]) < names.length) set(event.shiftKey ? "against" : "show", Number(digit[1]));
  } else if (keys[event.key]) keys[event.key]();
  else return;
  event.preventDefault();
}

for (const input of toolbar.querySelectorAll('[name="mode"]')) input.addEventListener("change", () => choose(input.value));
for (const id of ["show", "against", "split", "exposure"]) {
  element(id).addEventListener("input", (event) => set(id, Number(event.target.value)));
}
for (const button of document.querySelectorAll("[data-show]")) {
  button.addEventListener("click", () => set("show", Number(button.dataset.show)));
}
for (const viewer of viewers) viewer.canvas.addEventListener("dblclick", reset);
element("reset").addEventListener("click", reset);
element("theme").addEventListener("click", switchTheme);
element("help").addEventListener("click", () => element("keys").showModal());
document.addEventListener("keydown", pressed);
addEventListener("hashchange", () => { recall(); changed(); });

recall();
changed();

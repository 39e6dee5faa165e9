// Programs of blocks: the editor, which is loaded when its tab is opened first, and the programs that the server keeps.
import { send } from "./connection.js";
import { bind, byId } from "./parts.js";
import { onTab } from "./tabs.js";
import { text as textOf, view } from "./view.js";

const VENDOR = "/static/vendor/blockly-12.5.1/"; // not below the path of this file, because the content policy has hashes of this text
const SIZE_MAX = 65536; // of a program (bytes); 600 blocks are smaller
const SAVE_MS = 1000; // shortest time between two saves
const SMALL = matchMedia("(max-width: 700px)");
const NEW = { blocks: { languageVersion: 0, blocks: [{ type: "start", x: 24, y: 24 }] } };
const LOST_MS = 20000; // time without a running program after which a lost connection has ended none
const MARGIN = 20; // px between the edges and the first block
const PARTS = ["yaw", "pitch", "roll"], ARMS = ["short", "middle", "long"];
const COLOURS = { move: "#2f6fd0", control: "#a85a00", values: "#2b7d3e", variables: "#a63d84" };
// The blocks of each category, with the numbers of their inputs.
const CATEGORIES = {
  move: [["turn", { ANGLE: 20 }], ["nod", { ANGLE: 10 }], ["tilt", { ANGLE: 10 }], ["home"], ["arm", { ANGLE: 20 }], ["gesture"], ["speed", { SPEED: 30 }]],
  control: [["wait", { SECONDS: 1 }], ["controls_repeat_ext", { TIMES: 3 }], ["forever"], ["controls_if"], ["controls_if", {}, { hasElse: true }], ["controls_whileUntil"], ["wait_stop"]],
  values: [["math_number"], ["position"], ["math_arithmetic", { A: 1, B: 1 }], ["logic_compare", { A: 1, B: 1 }], ["logic_operation"], ["logic_negate"], ["logic_boolean"]],
  variables: [["variables_set"], ["math_change"], ["variables_get"]],
};

let asLesson; // returns what the button Run asks for besides the program
let workspace = null; // the editor, once it is loaded
let language = ""; // of the editor
let types = null; // the blocks of a lesson; null: all
let open = { name: "", owner: "", program: "" };
let taken = null; // the message of the server with the program that was taken last
let saved = ""; // the program as the server has it
let ranAt = -Infinity; // time (ms) at which a program has ended; Infinity: it runs
let lost = false; // whether one ended with its connection
let timer = 0;
let marked = ""; // the result that is shown at a block
let broken = ""; // key of the sentence about a program that the editor cannot show

const text = (key, values) => textOf(`page.block_${key}`, values);
const current = () => JSON.stringify(Blockly.serialization.workspaces.save(workspace));
const unsaved = () => Boolean(workspace) && !open.owner && current() !== saved;

// -- blocks -------------------------------------------------------------------------------------------

function define() {
  const number = (name) => ({ type: "input_value", name, check: "Number" });
  const choice = (name, options, key) => ({ type: "field_dropdown", name, options: options.map((one) => [textOf(key(one)), one]) });
  const gestures = () => view.gestures.gestures.map(([name, emoji, button]) => [`${emoji} ${button.text}`.trim(), name]);
  const part = (one) => (ARMS.includes(one) ? `arm.${one}` : `label.${one}`);
  const block = (type, args = [], more = {}) => ({
    type, message0: text(type), args0: args, tooltip: text(`${type}_tip`), style: "move_blocks",
    inputsInline: true, previousStatement: null, nextStatement: null, ...more,
  });
  const control = { style: "loop_blocks" }, last = { previousStatement: null, nextStatement: undefined };
  const blocks = [
    block("start", [], { style: "hat_blocks", previousStatement: undefined }),
    ...["turn", "nod", "tilt"].map((type) => block(type, [number("ANGLE")])),
    block("home"),
    block("arm", [choice("ARM", ARMS, part), number("ANGLE")]),
    block("gesture", [{ type: "field_dropdown", name: "NAME", options: gestures() }]),
    block("speed", [number("SPEED")]),
    block("wait", [number("SECONDS")], control),
    block("forever", [{ type: "input_dummy" }, { type: "input_statement", name: "DO" }], { ...control, ...last }),
    block("wait_stop", [], { ...control, ...last }),
    block("position", [choice("PART", [...PARTS, ...ARMS], part)], { style: "math_blocks", output: "Number", ...last, previousStatement: undefined }),
  ];
  for (const { type } of blocks) delete Blockly.Blocks[type];
  Blockly.defineBlocksWithJsonArray(blocks);
  const { init } = Blockly.Blocks.gesture;
  Blockly.Blocks.gesture.init = function initWithNewestGestures() {
    init.call(this);
    this.getField("NAME").menuGenerator_ = gestures;
  };
}

const shadows = (numbers) => Object.fromEntries(Object.entries(numbers).map(([name, NUM]) => [name, { shadow: { type: "math_number", fields: { NUM } } }]));

function toolbox() {
  const item = ([type, numbers = {}, extraState]) => ({ kind: "block", type, extraState, inputs: shadows(numbers) });
  const contents = Object.entries(CATEGORIES).map(([name, blocks]) => {
    const offered = blocks.filter(([type]) => !types || types.includes(type));
    const category = { kind: "category", name: text(name), categorystyle: `${name}_category` };
    return name === "variables" ? { ...category, custom: offered.length ? "VARIABLE" : "" } : { ...category, contents: offered.map(item) };
  });
  return { kind: "categoryToolbox", contents: contents.filter((one) => one.custom || one.contents?.length) };
}

function theme() {
  const style = (name) => ({ colourPrimary: COLOURS[name] });
  const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
  return Blockly.Theme.defineTheme("beatrix", {
    name: "beatrix",
    blockStyles: {
      move_blocks: style("move"), loop_blocks: style("control"), hat_blocks: { ...style("control"), hat: "cap" },
      logic_blocks: style("values"), math_blocks: style("values"), variable_blocks: style("variables"),
    },
    categoryStyles: Object.fromEntries(Object.entries(COLOURS).map(([name, one]) => [`${name}_category`, { colour: one }])),
    componentStyles: {
      workspaceBackgroundColour: colour("field"), toolboxBackgroundColour: colour("panel"), toolboxForegroundColour: colour("text"),
      flyoutBackgroundColour: colour("raised"), flyoutForegroundColour: colour("text"), flyoutOpacity: 1, scrollbarColour: colour("edge"),
    },
  });
}

// -- the editor ---------------------------------------------------------------------------------------

const load = (file) => new Promise((done, fail) => {
  const script = Object.assign(document.createElement("script"), { src: `${VENDOR}${file}.js`, onload: done, onerror: fail });
  document.head.append(script);
});

let loading = null;
async function start() {
  if (!view.texts["page.block_start"] || byId("blocks").hidden) return;
  if (language === view.language) return void (workspace && Blockly.svgResize(workspace));
  language = view.language;
  try {
    await (loading ??= load("blockly_compressed").then(() => load("blocks_compressed")).then(adapt));
    await load(`msg/${language}`);
  } catch {
    [loading, language] = [null, ""];
    return void note(text("not_loaded"));
  }
  if (workspace) keep();
  inject();
}

// What of Blockly does not suit this page: dialogs that would stop its heartbeats; the gear and colour of `if`.
function adapt() {
  Blockly.dialog.setPrompt(ask);
  Blockly.dialog.setConfirm((question, answer) => ask(question, null, (given) => answer(given !== null)));
  Blockly.dialog.setAlert((sentence, done) => { note(sentence); done?.(); });
  const { init } = Blockly.Blocks.controls_if;
  Blockly.Blocks.controls_if.init = function initWithoutGear() {
    init.call(this);
    this.setMutator(null);
    this.setStyle("loop_blocks");
  };
}

function inject() {
  const program = workspace && current();
  workspace?.dispose();
  define();
  workspace = Blockly.inject("workspace", {
    toolbox: toolbox(), theme: theme(), renderer: "zelos", media: `${VENDOR}media/`,
    rendererOverrides: { FIELD_DROPDOWN_SVG_ARROW_DATAURI: `${VENDOR}media/dropdown-arrow.svg` },
    readOnly: Boolean(open.owner), maxBlocks: 600, sounds: false, comments: false, collapse: false, disable: false, modalInputs: false,
    trashcan: true, maxTrashcanContents: 0, move: { wheel: true },
    zoom: { controls: !SMALL.matches, pinch: true, startScale: SMALL.matches ? 0.65 : 0.8, minScale: 0.4, maxScale: 1.5 },
  });
  workspace.addChangeListener(changed);
  workspace.registerToolboxCategoryCallback("VARIABLE", (own) => Blockly.Variables.flyoutCategory(own, false).map(
    (item) => (item.type === "variables_set" ? { ...item, inputs: shadows({ VALUE: 0 }) } : item)));
  Blockly.svgResize(workspace);
  show(program ?? open.program);
  marked = "";
  if (view.blocks) showRun(view.blocks);
}

// Shows a program in the editor; a program that cannot be shown leaves an empty one, and its file as it is.
function show(program) {
  const fill = (state) => Blockly.serialization.workspaces.load(state, workspace);
  try {
    fill(program ? JSON.parse(program) : NEW);
    broken = "";
  } catch {
    fill(NEW);
    open.name = freeName(open.name);
    broken = "page.block_bad_file";
  }
  if (!workspace.getBlocksByType("start").length) Blockly.serialization.blocks.append(NEW.blocks.blocks[0], workspace);
  for (const block of workspace.getBlocksByType("start")) block.setDeletable(false);
  const { left, top } = workspace.getBlocksBoundingBox();
  workspace.scroll(MARGIN - left * workspace.scale, MARGIN - top * workspace.scale);
  workspace.clearUndo();
  saved = current();
}

function changed(event) {
  if (event.isUiEvent) return;
  for (const block of workspace.getAllBlocks()) block.getSvgRoot().classList.toggle("loose", !block.getParent() && block.type !== "start");
  if (!open.owner) timer ||= setTimeout(keep, SAVE_MS);
}

// Sends the program to the server, if it has changed, and returns it.
function keep(ran = false) {
  clearTimeout(timer);
  timer = 0;
  const program = current();
  if (!open.owner && (ran || program !== saved) && send({ do: "save_program", name: open.name, program, ran })) saved = program;
  return program;
}

// Keeps a program under another name; the page shows it when the server has it.
function keepAs(name, program) {
  keep();
  send({ do: "save_program", name, program, opens: true });
}

function freeName(wanted) {
  const names = view.programs.names.map((one) => one.toLowerCase());
  const numbered = (number) => (number > 1 ? `${wanted} ${number}` : wanted);
  let number = 1;
  while (names.includes(numbered(number).toLowerCase())) number += 1;
  return numbered(number);
}

// Asks for a text (`value`: null asks only whether), in the page: a dialog of the browser would hide STOP.
function ask(question, value, answer) {
  const form = byId("block-ask"), field = byId("block-answer");
  byId("block-question").textContent = question;
  field.hidden = value === null;
  field.value = value ?? "";
  const end = (given) => { form.hidden = true; answer(given); };
  form.onsubmit = (event) => { event.preventDefault(); end(field.value.trim() || null); };
  form.onreset = () => end(null);
  form.hidden = false;
  (value === null ? form.querySelector("button") : field).focus();
}

function note(sentence) {
  byId("block-note").textContent = sentence;
}

// -- the parts of the view ----------------------------------------------------------------------------

function showRun({ run, end, runs, block, text: result, at }) {
  if (runs) ranAt = Infinity;
  else if (ranAt === Infinity) ranAt = performance.now();
  lost &&= !runs && !result;
  bind(byId("block-run"), run, () => {
    if (!view.you.drives) scrollTo(0, 0); // to the button Drive
    return { program: keep(true), ...asLesson() };
  });
  bind(byId("block-end"), end);
  byId("block-run").disabled ||= !workspace;
  byId("block-result").textContent = lost ? text("lost") : result;
  byId("block-result").classList.toggle("refused", Boolean(at));
  workspace?.highlightBlock(block || null);
  if (!workspace || marked === at + result) return;
  marked = at + result;
  for (const one of workspace.getAllBlocks()) one.setWarningText(null);
  const refused = at && workspace.getBlockById(at);
  if (!refused) return;
  refused.setWarningText(result);
  workspace.scrollBoundsIntoView(refused.getBoundingRectangleWithoutChildren());
  Blockly.common.setSelected(refused);
}

function showPrograms({ names, others, python, wrong, note: [key, slots] }) {
  const list = byId("block-programs"), shown = names.includes(open.name) || open.owner ? names : [open.name, ...names];
  const option = (owner, name) => new Option(owner ? `${owner}: ${name}` : name, JSON.stringify([owner, name]));
  list.replaceChildren(...shown.map((name) => option("", name)), ...others.map(([owner, name]) => option(owner, name)));
  list.value = JSON.stringify([open.owner, open.name]);
  byId("block-code").value = wrong ? `# ${textOf(...wrong)}` : python;
  note((broken || key) && textOf(broken || key, slots));
}

function showOpened(opened) {
  if (opened === taken) return; // shown again, in another language
  taken = opened;
  if (unsaved()) return void keep(); // it was changed while the server was lost
  const other = opened.owner !== open.owner;
  open = { ...opened, name: opened.name || text("first") };
  if (!workspace) return;
  if (other) inject();
  if (other || opened.program !== current()) show(opened.program);
}

// A new connection knows nothing of a program that ended with the one before.
export function disconnected() {
  lost = performance.now() - ranAt < LOST_MS;
}

export const BLOCKS = {
  opened: (opened) => { showOpened(opened); start(); },
  programs: showPrograms,
  blocks: showRun,
};

// Offers the blocks of a lesson; null: all blocks.
export function showToolbox(wanted) {
  types = wanted;
  if (workspace && !workspace.options.readOnly) workspace.updateToolbox(toolbox()); // a program to look at has none
}

// Offers the blocks of a lesson, and opens its program, which has the lesson's name.
export function openLesson(name, wanted) {
  showToolbox(wanted);
  if (open.name === name && !open.owner) return;
  if (view.programs.names.includes(name)) {
    if (workspace) keep();
    send({ do: "open_program", seat: "", name });
  } else if (workspace) keepAs(name, JSON.stringify(NEW));
  else send({ do: "save_program", name, program: JSON.stringify(NEW), opens: true });
}

// -- buttons ------------------------------------------------------------------------------------------

function saveFile() {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([current()], { type: "application/json" }));
  link.download = `${open.name}.json`;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), SAVE_MS);
}

async function loadFile({ target }) {
  const [file] = target.files;
  target.value = "";
  const name = file.name.replace(/\.json$/i, "").replace(/[^\p{L}\p{N}_ -]+/gu, " ").trim().slice(0, 36).trim();
  if (file.size > SIZE_MAX) return note(textOf("page.program_large", { name }));
  const program = await file.text();
  try {
    JSON.parse(program).blocks.blocks.map((block) => block.type);
  } catch {
    return note(text("bad_file"));
  }
  keepAs(freeName(name || text("first")), program);
}

function copy() {
  byId("block-code").select(); // over plain HTTP a browser copies only what is selected
  note(text(document.execCommand("copy") ? "copied" : "not_copied"));
}

export function connectBlocks(lesson) {
  asLesson = lesson;
  onTab("drive", () => byId("head").prepend(byId("stage")));
  for (const tab of ["blocks", "lessons"]) onTab(tab, () => { byId("block-stage").append(byId("stage")); start(); });
  onTab("blocks", () => send({ do: "open_program", name: "" })); // other pages have perhaps added programs
  byId("block-programs").onchange = (event) => {
    const [seat, name] = JSON.parse(event.target.value);
    if (workspace) keep();
    send({ do: "open_program", seat, name });
  };
  byId("block-new").onclick = () => keepAs(freeName(text("first")), JSON.stringify(NEW));
  byId("block-name").onclick = () => ask(text("name_tip"), open.name, (name) => { if (name) keepAs(name, current()); });
  byId("block-save").onclick = saveFile;
  byId("block-load").onclick = () => byId("block-file").click();
  byId("block-file").onchange = loadFile;
  for (const name of ["menu", "python"]) byId(`block-${name}`).onclick = () => { byId("blocks").classList.toggle(name); if (workspace) Blockly.svgResize(workspace); };
  byId("block-copy").onclick = copy;
  const leave = () => { if (unsaved()) keep(); };
  addEventListener("pagehide", leave);
  document.addEventListener("visibilitychange", () => { if (document.hidden) leave(); });
  addEventListener("beforeunload", (event) => { leave(); if (unsaved()) event.preventDefault(); });
}

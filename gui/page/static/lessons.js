// Lessons: their text and hints beside the blocks that they need; running the blocks is the check.
import { openLesson, showToolbox } from "./blocks.js";
import { send } from "./connection.js";
import { byId, make } from "./parts.js";
import { onTab } from "./tabs.js";
import { text, view } from "./view.js";

const MARKS = { passed: "✓", tried: "○" };
const KINDS = { heading: "h3", text: "p", item: "li" };

let shown = ""; // lesson and language of the text that is shown
let asked = false; // whether a hint was asked for
let offered = ""; // the lesson whose blocks are offered

const opens = () => document.body.dataset.tab === "lessons";
const chosen = () => view.lessons.find((one) => one.name === localStorage.getItem("lesson")) ?? view.lessons[0];

function show() {
  if (!view.lessons || !view.studied) return;
  const lesson = chosen(), { hints = [], more = 3 } = view.studied[lesson.name] ?? {};
  const mark = ({ name }) => (view.studied[name]?.passed ? MARKS.passed : view.studied[name]?.tries ? MARKS.tried : " ");
  byId("lesson-list").replaceChildren(...view.lessons.map((one) => new Option(`${mark(one)} ${one.title}`, one.name)));
  byId("lesson-list").value = lesson.name;
  const had = byId("lesson-hints").childElementCount;
  byId("lesson-hints").replaceChildren(...hints.map((hint) => make("li", hint)));
  if (asked && hints.length > had) byId("lesson-hints").lastChild.scrollIntoView({ block: "nearest" });
  asked = false;
  byId("lesson-hint").disabled = more < 1;
  byId("lesson-hint").textContent = text(more < 1 ? "page.lesson_no_hint" : "page.lesson_hint", { more });
  if (shown === lesson.name + view.language) return;
  shown = lesson.name + view.language;
  const paragraphs = lesson.text.map(({ kind, text: words }) => make(KINDS[kind], words));
  byId("lesson-text").replaceChildren(make("p", lesson.goal, "goal"), ...paragraphs);
}

// Returns an image that shows an SVG; its text can run no script there.
function drawn(svg, image, alt) {
  image.src = URL.createObjectURL(new Blob([svg], { type: "image/svg+xml" }));
  image.onload = () => URL.revokeObjectURL(image.src);
  image.alt = alt;
  return image;
}

function showCheck({ lesson, checks, result, asked, found, means, picture }) {
  const box = byId("lesson-check");
  box.hidden = !lesson;
  if (!lesson) return;
  const title = view.lessons.find((one) => one.name === lesson)?.title ?? "";
  const line = (key, words) => { const row = make("p"); row.append(make("b", `${text(key)} `), words); return row; };
  box.className = checks ? "" : result;
  box.replaceChildren(make("strong", text(`page.lesson_${checks ? "checks" : result || "not_judged"}`, { title })));
  if (asked) box.append(line("page.lesson_asked", asked), line("page.lesson_found", found));
  if (means) box.append(make("p", means));
  if (picture) box.append(drawn(picture, make("img"), text("page.lesson_picture")));
  if (!result) return;
  byId("blocks").classList.add("task"); // on a phone the sentence comes to the front
  byId("lesson").scrollTop = 0;
}

// Offers the blocks of the lesson in its tab, and all blocks in the other one; a lesson has a program of its own.
function offer() {
  const name = opens() && view.lessons ? chosen().name : "";
  if (name === offered) return;
  offered = name;
  if (name) openLesson(name, chosen().blocks);
  else showToolbox(null);
}

export const LESSONS = {
  lessons: () => { show(); offer(); },
  studied: show,
  check: showCheck,
};

// What the button Run asks for besides its program.
export const asLesson = () => (opens() && view.lessons ? { do: "check_program", lesson: chosen().name } : {});

export function connectLessons() {
  onTab("lessons", () => { byId("blocks").classList.add("task"); show(); offer(); });
  onTab("blocks", offer);
  byId("lesson-list").onchange = (event) => {
    localStorage.setItem("lesson", event.target.value);
    byId("lesson-check").hidden = true;
    show();
    offer();
  };
  byId("lesson-hint").onclick = () => { asked = true; send({ do: "hint", lesson: chosen().name }); };
  byId("lesson-task").onclick = () => { byId("blocks").classList.toggle("task"); dispatchEvent(new Event("resize")); };
}

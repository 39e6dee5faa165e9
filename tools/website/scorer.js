// Sphinx's scores of matches, but decisions last: most readers search for what to do.
const Scorer = {
  objNameMatch: 11,
  objPartialMatch: 6,
  objPrio: { 0: 15, 1: 5, 2: -5 },
  objPrioDefault: 0,
  title: 15,
  partialTitle: 7,
  term: 5,
  partialTerm: 2,
  score: ([page, title, anchor, description, score]) => (page.includes("/decisions/") ? score - 20 : score),
};

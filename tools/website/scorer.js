// Sphinx's scores of matches, but decisions last and how-to pages before others: most readers search for what to do.
// `var`, because Sphinx declares it, too.
var Scorer = {
  objNameMatch: 11,
  objPartialMatch: 6,
  objPrio: { 0: 15, 1: 5, 2: -5 },
  objPrioDefault: 0,
  title: 15,
  partialTitle: 7,
  term: 5,
  partialTerm: 2,
  score: ([page, title, anchor, description, score]) =>
    score + (page.includes("/decisions/") ? -20 : page.includes("/how-to/") ? 3 : 0),
};

// Colours and measures of the editor. Those of the page are in force where it has them.

import { HighlightStyle, syntaxHighlighting } from "@codemirror/language";
import { EditorView } from "@codemirror/view";
import { tags } from "@lezer/highlight";

/** Time that a changed text flashes [ms]. */
export const FLASH_TIME = 1200;

const palette = (scheme, colours) => {
  const variables = Object.entries(colours).map(([name, colour]) => [`--editor-${name}`, `var(--${name}, ${colour})`]);
  const rules = { "&": { colorScheme: scheme, ...Object.fromEntries(variables) } };
  return EditorView.theme(rules, { dark: scheme === "dark" });
};

export const light = palette("light", {
  page: "#fff",
  ink: "#222",
  quiet: "#5a5a5a",
  line: "#c8c8c8",
  accent: "#0072b2",
  "code-key": "#1c5a94",
  "code-heading": "#7a2472",
  "code-text": "#2b6530",
  "code-number": "#964000",
  "code-comment": "#585e67",
  "code-error": "#c0392b",
  "code-warning": "#9a6700",
  "code-panel": "#f5f6f7",
  "code-row": "#f5f7fa",
  "code-selection": "#cfe3f5",
  "code-mark": "#fff0c2",
  "code-flash": "#ffd66b",
});

export const dark = palette("dark", {
  page: "#16181b",
  ink: "#e4e4e4",
  quiet: "#a5a5a5",
  line: "#454a50",
  accent: "#56b4e9",
  "code-key": "#8cbcf0",
  "code-heading": "#e2a5dc",
  "code-text": "#9ed3a0",
  "code-number": "#f0b183",
  "code-comment": "#abb2bc",
  "code-error": "#ff8a7a",
  "code-warning": "#e3b341",
  "code-panel": "#202327",
  "code-row": "#1d2024",
  "code-selection": "#213f5a",
  "code-mark": "#3b3219",
  "code-flash": "#4f400d",
});

const colour = (name) => `var(--editor-${name})`;
const line = `1px solid ${colour("line")}`;
const mono = 'ui-monospace, "SF Mono", Menlo, Consolas, "DejaVu Sans Mono", monospace';
const sans = "system-ui, Helvetica, Arial, sans-serif";
const wavy = (name) => ({
  backgroundImage: "none",
  paddingBottom: "0",
  textDecoration: `underline wavy ${colour(name)} 1px`,
  textDecorationSkipInk: "none",
  textUnderlineOffset: "3px",
});
const sign = (name, shape) => ({ content: '""', background: colour(name), clipPath: shape });
const box = { background: colour("page"), color: colour("ink"), border: line, borderRadius: "4px" };

const theme = EditorView.theme({
  "&": { height: "100%", fontSize: "13px", background: colour("page"), color: colour("ink") },
  "&.cm-focused": { outline: "none" },
  // A frame that is seen with the keyboard, and does not move the text.
  "&::after": { content: '""', position: "absolute", inset: "0", pointerEvents: "none", zIndex: "250" },
  "&.cm-focused::after": { boxShadow: `inset 0 0 0 1px ${colour("accent")}` },
  ".cm-scroller": { overflow: "auto", fontFamily: mono, lineHeight: "1.55", overscrollBehavior: "contain" },
  ".cm-content": { padding: "6px 0 30vh", caretColor: colour("ink") },
  // The rest of a wrapped line goes in.
  ".cm-line": { padding: "0 10px 0 calc(4px + 2ch)", textIndent: "-2ch" },
  ".cm-cursor, .cm-dropCursor": { borderLeft: `2px solid ${colour("ink")}`, marginLeft: "-1px" },
  // In the words of CodeMirror's own rules, which are for the focused editor alone.
  "& > .cm-scroller > .cm-selectionLayer .cm-selectionBackground, &.cm-focused > .cm-scroller > .cm-selectionLayer .cm-selectionBackground":
    { background: colour("code-selection") },
  ".cm-activeLine, .cm-activeLineGutter": { background: "none" },
  "&.cm-focused .cm-activeLine": { background: colour("code-row") },
  "&.cm-focused .cm-activeLineGutter": { color: colour("ink") },
  ".cm-gutters": { background: colour("page"), color: colour("quiet"), border: "none" },
  ".cm-lineNumbers .cm-gutterElement": {
    padding: "0 6px 0 2px",
    minWidth: "2.4ch",
    fontVariantNumeric: "tabular-nums",
  },
  ".cm-gutter-lint": { width: "15px" },
  ".cm-gutter-lint .cm-gutterElement": { padding: "calc((1.55em - 9px)/2) 0 0 5px" },
  ".cm-lint-marker": { display: "block", width: "9px", height: "9px" },
  ".cm-lint-marker-error": sign("code-error", "circle(50%)"),
  ".cm-lint-marker-warning": sign("code-warning", "polygon(50% 0, 100% 100%, 0 100%)"),
  ".cm-lint-marker-info": sign("accent", "inset(1px)"),
  ".cm-lintRange-error": wavy("code-error"),
  ".cm-lintRange-warning": wavy("code-warning"),
  ".cm-lintRange-info": wavy("accent"),
  ".cm-lintPoint-error::after": { borderBottomColor: colour("code-error") },
  ".cm-lintPoint-warning::after": { borderBottomColor: colour("code-warning") },
  ".cm-lintPoint-info::after": { borderBottomColor: colour("accent") },
  "&.cm-focused .cm-matchingBracket": {
    background: "none",
    outline: `1px solid ${colour("quiet")}`,
    borderRadius: "2px",
  },
  "&.cm-focused .cm-nonmatchingBracket": { background: "none", outline: `1px solid ${colour("code-error")}` },
  ".cm-searchMatch": { background: colour("code-mark"), outline: `1px solid ${colour("code-warning")}` },
  ".cm-searchMatch-selected": { background: colour("code-flash") },
  ".cm-marked": { background: colour("code-mark"), borderRadius: "2px" },
  "@media (prefers-reduced-motion: no-preference)": {
    ".cm-flash": { animation: `biela-flash ${FLASH_TIME}ms ease-out` },
  },
  "@keyframes biela-flash": { from: { background: colour("code-flash") }, to: { background: "transparent" } },

  ".cm-tooltip": { ...box, fontFamily: sans, boxShadow: "0 2px 10px rgb(0 0 0 / 18%)", zIndex: "300" },
  ".cm-tooltip code": {
    fontFamily: mono,
    fontSize: "0.95em",
    background: colour("code-panel"),
    borderRadius: "3px",
    padding: "0 3px",
  },
  ".cm-tooltip-lint": {
    maxWidth: "min(34rem, 94vw)",
    boxSizing: "border-box",
    borderRadius: "3px",
    overflow: "hidden",
  },
  ".cm-diagnostic": { padding: "5px 9px", whiteSpace: "pre-line", overflowWrap: "anywhere", borderLeft: "4px solid" },
  ".cm-diagnostic-error": { borderLeftColor: colour("code-error") },
  ".cm-diagnostic-warning": { borderLeftColor: colour("code-warning") },
  ".cm-diagnostic-info": { borderLeftColor: colour("accent") },
  ".cm-diagnostic .cm-help": { display: "block", color: colour("quiet") },
  ".cm-tooltip.cm-tooltip-autocomplete > ul": {
    fontFamily: mono,
    maxHeight: "min(16em, 40vh)",
    minWidth: "min(14rem, 90vw)",
  },
  ".cm-tooltip.cm-tooltip-autocomplete > ul > li": {
    display: "flex",
    gap: "1.5em",
    justifyContent: "space-between",
    padding: "3px 9px",
    lineHeight: "1.4",
  },
  ".cm-tooltip-autocomplete ul li[aria-selected]": { background: colour("code-selection"), color: colour("ink") },
  ".cm-completionMatchedText": { textDecoration: "none", fontWeight: "700" },
  ".cm-completionDetail": {
    margin: "0",
    color: colour("quiet"),
    fontStyle: "normal",
    fontFamily: sans,
    overflow: "hidden",
    textOverflow: "ellipsis",
    whiteSpace: "nowrap",
  },
  "li[aria-selected] .cm-completionDetail": { color: colour("ink") },
  ".cm-tooltip.cm-completionInfo": {
    padding: "6px 9px",
    maxWidth: "min(22rem, 90vw)",
    lineHeight: "1.45",
    overflowWrap: "anywhere",
  },

  ".cm-panels": { background: colour("code-panel"), color: colour("ink"), fontFamily: sans, zIndex: "200" },
  ".cm-panels-top": { borderBottom: line },
  ".cm-panels-bottom": { borderTop: line },
  ".cm-panel.cm-search": {
    display: "flex",
    flexWrap: "wrap",
    gap: "4px 6px",
    alignItems: "center",
    padding: "6px 2rem 6px 8px",
    fontSize: "13px",
  },
  ".cm-panel.cm-search br": { flexBasis: "100%", height: "0", content: '""' },
  ".cm-panel.cm-search :is(input, button, label)": { margin: "0", fontSize: "13px" },
  ".cm-panel.cm-search label": { display: "inline-flex", alignItems: "center", gap: "3px" },
  ".cm-panel.cm-search [type=checkbox]": { accentColor: colour("accent") },
  ".cm-panel .cm-textfield": {
    ...box,
    flex: "1 1 9rem",
    minWidth: "0",
    maxWidth: "20rem",
    padding: "3px 6px",
    fontFamily: mono,
  },
  ".cm-panel .cm-button": { ...box, backgroundImage: "none", padding: "3px 9px", fontFamily: sans, cursor: "pointer" },
  ".cm-panel .cm-button:hover": { borderColor: colour("quiet") },
  ".cm-panel.cm-search [name=close]": {
    position: "absolute",
    top: "4px",
    right: "4px",
    width: "1.75rem",
    height: "1.75rem",
    fontSize: "16px",
    color: colour("quiet"),
    cursor: "pointer",
  },
  ".cm-panels :focus-visible": { outline: `2px solid ${colour("accent")}`, outlineOffset: "1px" },
  // Safari of phones enlarges the page round a smaller text that takes the focus.
  "@supports (-webkit-touch-callout: none)": {
    ".cm-scroller": { fontSize: "16px" },
    ".cm-panel.cm-search .cm-textfield": { fontSize: "16px" },
  },
});

const highlighting = HighlightStyle.define([
  { tag: tags.comment, color: colour("code-comment") },
  { tag: tags.heading, color: colour("code-heading"), fontWeight: "600" },
  { tag: tags.propertyName, color: colour("code-key") },
  { tag: tags.string, color: colour("code-text") },
  { tag: [tags.number, tags.bool], color: colour("code-number") },
  { tag: [tags.punctuation, tags.bracket], color: colour("code-comment") },
]);

export const look = [theme, syntaxHighlighting(highlighting)];

// Names that the scripts find in a page: those of the script for pictures that move, of the editor and of
// the completion; and properties that scripts give to elements.

declare const SVG: string;
declare const Parts: any;
declare function addTo(parent: Element, name: string): any;
declare function placePart(element: Element, ...place: number[]): void;
declare function stretchPath(path: Element, points: number[], long: number): void;
declare function arrow(tip: number[], partX: number, partY: number): string;
declare function fix(value: number): string;
declare const makeEditor: any;
declare function completions(...options: any[]): any;

interface Element {
  live?: any;
  studio?: any;
}
interface EventTarget {
  matches?: any;
}

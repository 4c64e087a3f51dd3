/** One cursor through all figures of a page that stand over the same quantity. */

interface Axis {
  _offset: number;
  _length: number;
  d2p: (value: number) => number;
  p2d: (pixels: number) => number;
}

/** Layout of a drawn plotly figure. */
type Drawn = HTMLElement & {
  _fullLayout?: { xaxis?: Axis; _size?: { t: number; h: number } };
};

const figures = new Map<string, Map<Drawn, HTMLElement>>();

/** Lets a figure follow the cursor of others; returns how it leaves. */
export function followCursor(link: string, figure: Drawn, line: HTMLElement): () => void {
  const group = figures.get(link) ?? new Map<Drawn, HTMLElement>();
  figures.set(link, group);
  group.set(figure, line);
  const moved = (event: MouseEvent) => {
    const xaxis = figure._fullLayout?.xaxis;
    if (xaxis === undefined) return;
    const along = event.clientX - figure.getBoundingClientRect().left - xaxis._offset;
    const inside = along >= 0 && along <= xaxis._length;
    moveCursor(link, figure, inside ? xaxis.p2d(along) : null);
  };
  const left = () => {
    moveCursor(link, figure, null);
  };
  figure.addEventListener("mousemove", moved);
  figure.addEventListener("mouseleave", left);
  return () => {
    figure.removeEventListener("mousemove", moved);
    figure.removeEventListener("mouseleave", left);
    group.delete(figure);
    if (group.size === 0) figures.delete(link);
  };
}

/** Shows in the other figures where the cursor is in one; null takes it away. */
function moveCursor(link: string, from: HTMLElement, x: number | null): void {
  for (const [figure, line] of figures.get(link) ?? []) {
    if (figure === from) continue;
    const place = x === null ? null : placeOf(figure, x);
    line.style.display = place === null ? "none" : "block";
    if (place !== null) Object.assign(line.style, place);
  }
}

function placeOf(figure: Drawn, x: number): Record<"left" | "top" | "height", string> | null {
  const layout = figure._fullLayout;
  if (layout?.xaxis === undefined || layout._size === undefined) return null;
  const { xaxis, _size: size } = layout;
  const along = xaxis.d2p(x);
  if (!(along >= 0 && along <= xaxis._length)) return null;
  return { left: `${xaxis._offset + along}px`, top: `${size.t}px`, height: `${size.h}px` };
}

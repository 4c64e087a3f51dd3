/** The part of plotly.js that we call; its specs come from the server as they are. */
declare module "plotly.js-cartesian-dist-min" {
  interface PlotlyElement extends HTMLElement {
    layout: Record<string, unknown>;
    on(event: string, listener: (payload: never) => void): void;
    removeAllListeners(event: string): void;
  }
  const Plotly: {
    react(
      element: HTMLElement,
      data: object[],
      layout: object,
      config?: object,
    ): Promise<PlotlyElement>;
    purge(element: HTMLElement): void;
    downloadImage(drawn: HTMLElement | object, options: object): Promise<string>;
    Plots: { resize(element: HTMLElement): Promise<void> };
  };
  export default Plotly;
}

/**
 * Plotly, loaded with the first figure of the visit, beside its data rather than after it: pages
 * without figures do not wait while it is evaluated. A figure that finds it missing, for the
 * connection was lost, asks again.
 */
const fetchPlotly = () => import("plotly.js-cartesian-dist-min").then((module) => module.default);
let plotly: ReturnType<typeof fetchPlotly> | undefined;
export const loadPlotly = () => (plotly = plotly?.catch(fetchPlotly) ?? fetchPlotly());

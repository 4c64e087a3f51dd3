/** Addresses and the pages behind them; each page is loaded when first opened. */
import {
  createRootRoute,
  createRoute,
  createRouter,
  lazyRouteComponent,
  redirect,
  retainSearchParams,
} from "@tanstack/react-router";
import { PageError } from "./components/frame/PageError";
import { AppFrame } from "./components/frame/AppFrame";
import { retryImport } from "./lib/retryImport";
import { parseSearch, stringifySearch, type Search } from "./lib/urlState";
import { NotFoundPage } from "./pages/NotFoundPage";
import {
  aircraftView,
  COMPARE_TABS,
  MANEUVER_TABS,
  RUN_TABS,
  batchView,
  campaignView,
  compareView,
  conditionView,
  designView,
  excitationView,
  importView,
  flightView,
  liveStreamView,
  liveView,
  flutterView,
  globalModelVersionView,
  globalModelView,
  frameView,
  glossaryView,
  jobsView,
  maneuverView,
  decisionsView,
  decisionView,
  modelStructuresView,
  newDecisionView,
  modelStructureView,
  newRunView,
  runsView,
  runView,
  modalDataView,
} from "./views";

/** A page, loaded when first opened, also over a server that comes back. */
const page: typeof lazyRouteComponent = (load, name) => lazyRouteComponent(retryImport(load), name);

const root = createRootRoute({
  validateSearch: frameView,
  // A link in other units opens further pages in them, too.
  search: { middlewares: [retainSearchParams(["units", "frequency_unit"])] },
  component: AppFrame,
  notFoundComponent: NotFoundPage,
  errorComponent: PageError,
});

const byId = {
  parse: ({ id }: { id: string }) => ({ id: /^\d{1,15}$/.test(id) ? Number(id) : 0 }),
  stringify: ({ id }: { id: number }) => ({ id: String(id) }),
};

interface Target {
  to: string;
  search: Search;
  hash?: string;
}

function redirectTo({ to, search, hash }: Target): never {
  // The target is a page of its own, whose parser reads the search parameters.
  throw redirect({ to: to as "/", search: search as object, hash, replace: true });
}

/** Opens the section that a former tab has become. */
const openSection =
  (tabs: Readonly<Record<string, readonly string[]>>) =>
  ({ location: { pathname, search } }: { location: { pathname: string; search: Search } }) => {
    const { tab: named } = search;
    if (typeof named !== "string" || named in tabs) return;
    const tab = Object.keys(tabs).find((one) => tabs[one]?.includes(named));
    if (tab !== undefined) redirectTo({ to: pathname, search: { ...search, tab }, hash: named });
  };

/** A former address, and where its page is now. */
const moved = <const Path extends string>(path: Path, find: (search: Search) => Target) =>
  createRoute({
    getParentRoute: () => root,
    path,
    beforeLoad: ({ location }) => {
      redirectTo(find(location.search));
    },
  });

const movedPages = [
  moved("/dashboard", (search) => ({ to: "/campaign", search, hash: "coverage" })),
  moved("/quality", (search) => ({ to: "/campaign", search: { ...search, columns: "quality" } })),
  moved("/validation", ({ run, maneuver, ...search }) => ({
    to: "/compare",
    search: { ...search, predicted_by: run, predicted: maneuver, tab: "validation" },
    hash: "validation",
  })),
  moved("/closed-loop", (search) => ({
    to: "/flutter",
    search: { ...search, tab: "closed-loop" },
  })),
  moved("/search", (search) => ({ to: "/model-structures", search, hash: "search" })),
  moved("/preflight-simulation", (search) => ({ to: "/excitation", search })),
  moved("/structures", (search) => ({ to: "/modal-data", search })),
] as const;

const start = createRoute({
  getParentRoute: () => root,
  path: "/",
  component: page(() => import("./pages/StartPage"), "StartPage"),
});

const campaign = createRoute({
  getParentRoute: () => root,
  path: "/campaign",
  validateSearch: campaignView,
  component: page(() => import("./pages/CampaignPage"), "CampaignPage"),
});

const conditions = createRoute({
  getParentRoute: () => root,
  path: "/conditions",
  component: page(() => import("./pages/ConditionsPage"), "ConditionsPage"),
});

const condition = createRoute({
  getParentRoute: () => root,
  path: "/conditions/$id",
  params: byId,
  validateSearch: conditionView,
  component: page(() => import("./pages/ConditionPage"), "ConditionPage"),
});

const maneuver = createRoute({
  getParentRoute: () => root,
  path: "/maneuvers/$id",
  params: byId,
  validateSearch: maneuverView,
  beforeLoad: openSection(MANEUVER_TABS),
  component: page(() => import("./pages/ManeuverPage"), "ManeuverPage"),
});

const flight = createRoute({
  getParentRoute: () => root,
  path: "/flights/$id",
  params: byId,
  validateSearch: flightView,
  component: page(() => import("./pages/FlightPage"), "FlightPage"),
});

const miniGvt = createRoute({
  getParentRoute: () => root,
  path: "/flights/$id/mini-gvt",
  params: byId,
  component: page(() => import("./pages/MiniGvtPage"), "MiniGvtPage"),
});

const live = createRoute({
  getParentRoute: () => root,
  path: "/live",
  validateSearch: liveView,
  component: page(() => import("./pages/LivePage"), "LivePage"),
});

const liveStream = createRoute({
  getParentRoute: () => root,
  path: "/live/$id",
  params: byId,
  validateSearch: liveStreamView,
  component: page(() => import("./pages/LiveStreamPage"), "LiveStreamPage"),
});

const newRun = createRoute({
  getParentRoute: () => root,
  path: "/maneuvers/$id/new-run",
  params: byId,
  validateSearch: newRunView,
  component: page(() => import("./pages/NewRunPage"), "NewRunPage"),
});

const run = createRoute({
  getParentRoute: () => root,
  path: "/runs/$id",
  params: byId,
  validateSearch: runView,
  beforeLoad: openSection(RUN_TABS),
  component: page(() => import("./pages/RunPage"), "RunPage"),
});

const runTemplates = createRoute({
  getParentRoute: () => root,
  path: "/run-templates",
  component: page(() => import("./pages/RunTemplatesPage"), "RunTemplatesPage"),
});

const runs = createRoute({
  getParentRoute: () => root,
  path: "/runs",
  validateSearch: runsView,
  component: page(() => import("./pages/RunsPage"), "RunsPage"),
});

const glossary = createRoute({
  getParentRoute: () => root,
  path: "/glossary",
  validateSearch: glossaryView,
  component: page(() => import("./pages/GlossaryPage"), "GlossaryPage"),
});

const compare = createRoute({
  getParentRoute: () => root,
  path: "/compare",
  validateSearch: compareView,
  beforeLoad: openSection(COMPARE_TABS),
  component: page(() => import("./pages/ComparePage"), "ComparePage"),
});

const flutter = createRoute({
  getParentRoute: () => root,
  path: "/flutter",
  validateSearch: flutterView,
  component: page(() => import("./pages/FlutterPage"), "FlutterPage"),
});

const modalData = createRoute({
  getParentRoute: () => root,
  path: "/modal-data",
  validateSearch: modalDataView,
  component: page(() => import("./pages/ModalDataPage"), "ModalDataPage"),
});

const groundTests = createRoute({
  getParentRoute: () => root,
  path: "/mini-gvt",
  component: page(() => import("./pages/MiniGvtPage"), "GroundTestsPage"),
});

const globalModel = createRoute({
  getParentRoute: () => root,
  path: "/global-model",
  validateSearch: globalModelView,
  component: page(() => import("./pages/GlobalModelPage"), "GlobalModelPage"),
});

const globalModelVersion = createRoute({
  getParentRoute: () => root,
  path: "/global-model/$id",
  params: byId,
  validateSearch: globalModelVersionView,
  component: page(() => import("./pages/GlobalModelVersionPage"), "GlobalModelVersionPage"),
});

const jobs = createRoute({
  getParentRoute: () => root,
  path: "/jobs",
  validateSearch: jobsView,
  component: page(() => import("./pages/JobsPage"), "JobsPage"),
});

const job = createRoute({
  getParentRoute: () => root,
  path: "/jobs/$id",
  params: byId,
  component: page(() => import("./pages/JobPage"), "JobPage"),
});

const batch = createRoute({
  getParentRoute: () => root,
  path: "/batches/$id",
  params: byId,
  validateSearch: batchView,
  component: page(() => import("./pages/BatchPage"), "BatchPage"),
});

const aircraft = createRoute({
  getParentRoute: () => root,
  path: "/aircraft",
  validateSearch: aircraftView,
  component: page(() => import("./pages/AircraftPage"), "AircraftPage"),
});

const newAircraft = createRoute({
  getParentRoute: () => root,
  path: "/aircraft/new",
  component: page(() => import("./pages/NewAircraftPage"), "NewAircraftPage"),
});

const account = createRoute({
  getParentRoute: () => root,
  path: "/account",
  component: page(() => import("./pages/AccountPage"), "AccountPage"),
});

const tokens = createRoute({
  getParentRoute: () => root,
  path: "/tokens",
  component: page(() => import("./pages/TokensPage"), "TokensPage"),
});

const excitation = createRoute({
  getParentRoute: () => root,
  path: "/excitation",
  validateSearch: excitationView,
  component: page(() => import("./pages/ExcitationPage"), "ExcitationPage"),
});

const modelStructures = createRoute({
  getParentRoute: () => root,
  path: "/model-structures",
  validateSearch: modelStructuresView,
  component: page(() => import("./pages/ModelStructuresPage"), "ModelStructuresPage"),
});

const decisions = createRoute({
  getParentRoute: () => root,
  path: "/decisions",
  validateSearch: decisionsView,
  component: page(() => import("./pages/DecisionsPage"), "DecisionsPage"),
});

const newDecision = createRoute({
  getParentRoute: () => root,
  path: "/decisions/new",
  validateSearch: newDecisionView,
  component: page(() => import("./pages/NewDecisionPage"), "NewDecisionPage"),
});

const decision = createRoute({
  getParentRoute: () => root,
  path: "/decisions/$id",
  params: byId,
  validateSearch: decisionView,
  component: page(() => import("./pages/DecisionPage"), "DecisionPage"),
});

const modelStructure = createRoute({
  getParentRoute: () => root,
  path: "/model-structures/$id",
  params: byId,
  validateSearch: modelStructureView,
  component: page(() => import("./pages/ModelStructurePage"), "ModelStructurePage"),
});

const importPage = createRoute({
  getParentRoute: () => root,
  path: "/import",
  validateSearch: importView,
  component: page(() => import("./pages/ImportPage"), "ImportPage"),
});

const design = createRoute({
  getParentRoute: () => root,
  path: "/excitation/$id",
  params: byId,
  validateSearch: designView,
  component: page(() => import("./pages/DesignPage"), "DesignPage"),
});

/** Page of the last navigation. */
let openPage = "";

export const router = createRouter({
  routeTree: root.addChildren([
    start,
    campaign,
    conditions,
    condition,
    runs,
    runTemplates,
    glossary,
    maneuver,
    miniGvt,
    live,
    liveStream,
    flight,
    newRun,
    run,
    compare,
    flutter,
    globalModel,
    globalModelVersion,
    modalData,
    groundTests,
    jobs,
    job,
    batch,
    aircraft,
    newAircraft,
    account,
    tokens,
    excitation,
    design,
    importPage,
    modelStructures,
    modelStructure,
    decisions,
    newDecision,
    decision,
    ...movedPages,
  ]),
  parseSearch,
  stringifySearch,
  defaultPreload: "intent",
  defaultErrorComponent: PageError,
  // A control of a page changes its address, not the place that is read.
  scrollRestoration: ({ location: { pathname, hash } }) => {
    const isOther = pathname !== openPage;
    openPage = pathname;
    return isOther || hash !== "";
  },
});

declare module "@tanstack/react-router" {
  interface Register {
    router: typeof router;
  }
}

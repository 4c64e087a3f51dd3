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
import { parseSearch, stringifySearch } from "./lib/urlState";
import { NotFoundPage } from "./pages/NotFoundPage";
import {
  aircraftView,
  batchView,
  campaignView,
  closedLoopView,
  compareView,
  conditionView,
  dashboardView,
  designView,
  excitationView,
  importView,
  flightView,
  liveStreamView,
  liveView,
  flutterView,
  globalModelVersionView,
  globalModelView,
  searchView,
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
  qualityView,
  runsView,
  runView,
  modalDataView,
  validationView,
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

const dashboard = createRoute({
  getParentRoute: () => root,
  path: "/dashboard",
  validateSearch: dashboardView,
  component: page(() => import("./pages/DashboardPage"), "DashboardPage"),
});

const maneuver = createRoute({
  getParentRoute: () => root,
  path: "/maneuvers/$id",
  params: byId,
  validateSearch: maneuverView,
  component: page(() => import("./pages/ManeuverPage"), "ManeuverPage"),
});

const flight = createRoute({
  getParentRoute: () => root,
  path: "/flights/$id",
  params: byId,
  validateSearch: flightView,
  component: page(() => import("./pages/FlightPage"), "FlightPage"),
});

const quality = createRoute({
  getParentRoute: () => root,
  path: "/quality",
  validateSearch: qualityView,
  component: page(() => import("./pages/QualityPage"), "QualityPage"),
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
  component: page(() => import("./pages/ComparePage"), "ComparePage"),
});

const search = createRoute({
  getParentRoute: () => root,
  path: "/search",
  validateSearch: searchView,
  component: page(() => import("./pages/SearchPage"), "SearchPage"),
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

/** Former address of the modal data. */
const structures = createRoute({
  getParentRoute: () => root,
  path: "/structures",
  beforeLoad: ({ location }) => {
    throw redirect({
      to: "/modal-data",
      search: modalDataView(location.search),
      hash: location.hash,
      replace: true,
    });
  },
});

const preflight = createRoute({
  getParentRoute: () => root,
  path: "/preflight-simulation",
  component: page(() => import("./pages/PreflightPage"), "PreflightPage"),
});

const groundTests = createRoute({
  getParentRoute: () => root,
  path: "/mini-gvt",
  component: page(() => import("./pages/MiniGvtPage"), "GroundTestsPage"),
});

const closedLoop = createRoute({
  getParentRoute: () => root,
  path: "/closed-loop",
  validateSearch: closedLoopView,
  component: page(() => import("./pages/ClosedLoopPage"), "ClosedLoopPage"),
});

const validation = createRoute({
  getParentRoute: () => root,
  path: "/validation",
  validateSearch: validationView,
  component: page(() => import("./pages/ValidationPage"), "ValidationPage"),
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

export const router = createRouter({
  routeTree: root.addChildren([
    start,
    campaign,
    conditions,
    condition,
    dashboard,
    runs,
    runTemplates,
    glossary,
    maneuver,
    miniGvt,
    live,
    liveStream,
    quality,
    flight,
    newRun,
    run,
    compare,
    flutter,
    closedLoop,
    globalModel,
    globalModelVersion,
    validation,
    search,
    modalData,
    structures,
    preflight,
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
  ]),
  parseSearch,
  stringifySearch,
  defaultPreload: "intent",
  defaultErrorComponent: PageError,
  scrollRestoration: true,
});

declare module "@tanstack/react-router" {
  interface Register {
    router: typeof router;
  }
}

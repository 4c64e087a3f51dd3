import { Button, Group, Text } from "@mantine/core";
import { Link, useLocation } from "@tanstack/react-router";
import { setTour, useTour } from "../../lib/tour";
import { ButtonLink } from "../controls/ButtonLink";
import { useProposedManeuver } from "../designs/useProposedManeuver";

const N_STEPS = 5;
const MANEUVER = /^\/maneuvers\/(\d+)\/?$/;
const NEW_RUN = /^\/maneuvers\/\d+\/new-run\/?$/;

/** Offer of the guided tour on the start page. */
export function TourOffer() {
  const state = useTour();
  const proposed = useProposedManeuver();
  if (state !== "offered" || proposed == null) return null;
  return (
    <Group className="panel" p="sm" mb="md" justify="space-between" data-testid="tour-offer">
      <Text size="sm">
        Tour of five steps: from a recorded maneuver to derivatives by three methods, compared.
      </Text>
      <Group gap="xs">
        <Button
          data-testid="tour-start"
          onClick={() => {
            setTour("shown");
          }}
        >
          Start tour
        </Button>
        <Skip />
      </Group>
    </Group>
  );
}

/** Current step of the guided tour, which follows from the page that is shown. */
export function Tour() {
  return useTour() === "shown" ? <Step /> : null;
}

function Skip() {
  return (
    <Button
      variant="default"
      data-testid="tour-skip"
      onClick={() => {
        setTour("ended");
      }}
    >
      Skip tour
    </Button>
  );
}

function Step() {
  const { pathname, search } = useLocation();
  const proposed = useProposedManeuver();
  const maneuver = Number(MANEUVER.exec(pathname)?.[1] ?? 0);
  const step = stepOf(pathname, (search as { tab?: string }).tab);
  return (
    <Group
      className="panel no-print"
      role="status"
      p="sm"
      mb="md"
      justify="space-between"
      data-testid="tour"
      data-step={step}
    >
      <Text size="sm" maw={900}>
        {step !== 0 && (
          <b>
            Step {step} of {N_STEPS}.{" "}
          </b>
        )}
        {TEXTS[step]}
      </Text>
      <Group gap="xs">
        {step === 1 && proposed != null && (
          <ButtonLink
            to="/maneuvers/$id"
            params={{ id: proposed.id }}
            search={{}}
            data-testid="tour-next"
          >
            Open {proposed.label}
          </ButtonLink>
        )}
        {step === 2 && (
          <ButtonLink
            to="/maneuvers/$id/new-run"
            params={{ id: maneuver }}
            search={{ methods: ["OE", "FRE", "EE"] }}
            data-testid="tour-next"
          >
            New run
          </ButtonLink>
        )}
        {step === N_STEPS ? (
          <Button
            data-testid="tour-finish"
            onClick={() => {
              setTour("ended");
            }}
          >
            Finish tour
          </Button>
        ) : (
          <Skip />
        )}
      </Group>
    </Group>
  );
}

function stepOf(pathname: string, tab: string | undefined): number {
  if (pathname === "/") return 1;
  if (MANEUVER.test(pathname)) return tab === "runs" ? 4 : 2;
  if (NEW_RUN.test(pathname)) return 3;
  return pathname.startsWith("/compare") ? N_STEPS : 0;
}

const TEXTS = [
  <>
    The tour continues on the <Link to="/">start page</Link>.
  </>,
  "A campaign is a list of maneuvers, each flown at one airspeed and fuel. Proposed is a maneuver whose inputs are least correlated, so that their derivatives can be separated.",
  "The time histories show the surfaces excited by orthogonal multisines, and the response. Look at Spectra and Bode, then open a new run.",
  "The model structure is proposed from the excited band: modes and free derivatives. One run per method is submitted: output error, frequency-response error and equation error. Select Submit.",
  "Each run is a job. When all have succeeded, select Compare methods.",
  "Each point is an estimate with ±2σ; triangles are the prediction. Where the bars of the methods overlap, they are consistent. Point at a derivative or a column for its meaning.",
];

import { ButtonLink } from "./ButtonLink";

/** To the flutter prediction and the closed loop of runs. */
export function PredictLinks({ runs }: { runs: number[] }) {
  if (runs.length === 0) return null;
  return (
    <>
      <ButtonLink variant="default" to="/flutter" search={{ runs }} data-testid="predict-flutter">
        Flutter
      </ButtonLink>
      <ButtonLink variant="default" to="/closed-loop" search={{ runs }}>
        Closed loop
      </ButtonLink>
    </>
  );
}

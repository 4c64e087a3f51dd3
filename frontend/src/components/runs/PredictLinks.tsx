import { ButtonLink } from "../controls/ButtonLink";

/** To the flutter prediction and global model of runs. */
export function PredictLinks({ runs }: { runs: number[] }) {
  if (runs.length === 0) return null;
  return (
    <>
      <ButtonLink variant="default" to="/flutter" search={{ runs }} data-testid="predict-flutter">
        Flutter
      </ButtonLink>
      {runs.length > 3 && (
        <ButtonLink variant="default" to="/global-model" search={{ runs }}>
          Global model
        </ButtonLink>
      )}
    </>
  );
}

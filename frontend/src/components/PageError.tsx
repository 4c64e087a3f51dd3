import { useRouter } from "@tanstack/react-router";
import { ProblemAlert } from "./ProblemAlert";

/** Stands where a page broke; the frame around it keeps working. */
export function PageError({ error, reset }: { error: unknown; reset?: () => void }) {
  const router = useRouter();
  return (
    <ProblemAlert
      error={error}
      onRetry={() => {
        reset?.();
        void router.invalidate();
      }}
    />
  );
}

import { Alert } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { Link } from "@tanstack/react-router";
import { groundTestsQuery } from "../../api/queries";

/** Alert on every flight after which the mini-GVT shows a structural change. */
export function GroundTestAlarm() {
  const tests = useQuery(groundTestsQuery);
  const alarms = (tests.data ?? []).filter((test) => test.verdict === "alarm");
  return alarms.map((test) => (
    <Alert
      key={test.flight_id}
      variant="default"
      className="alarm"
      role="alert"
      mb="md"
      title={`Structural change in flight ${test.flight_number}`}
      data-testid="structure-alarm"
    >
      {test.message}{" "}
      <Link to="/flights/$id/mini-gvt" params={{ id: test.flight_id }} className="link">
        Mini-GVT of flight {test.flight_number}
      </Link>
    </Alert>
  ));
}

import { Alert } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { Link } from "@tanstack/react-router";
import { groundTestsQuery } from "../api/queries";

/** A word on every flight after which the structure is not what it was. */
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
      title={`Structure changed in flight ${test.flight_number}`}
      data-testid="structure-alarm"
    >
      {test.message}{" "}
      <Link to="/flights/$id/mini-gvt" params={{ id: test.flight_id }} className="link">
        Mini-GVT of flight {test.flight_number}
      </Link>
    </Alert>
  ));
}

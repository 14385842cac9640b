#!/bin/sh
# Run once by the Postgres image, on an empty database: the tables' owner, and the user that the service has. The owner
# alone may change tables; `treestroke migrate` grants the service what it needs.
set -eu
secrets=${SECRETS:-/run/secrets}
psql --quiet --set ON_ERROR_STOP=1 --username postgres --dbname postgres \
    --set owner="$(cat "$secrets/owner_password")" --set service="$(cat "$secrets/service_password")" <<END
CREATE ROLE treestroke_owner LOGIN PASSWORD :'owner';
CREATE ROLE treestroke LOGIN PASSWORD :'service';
CREATE DATABASE treestroke OWNER treestroke_owner;
REVOKE ALL ON DATABASE treestroke FROM PUBLIC;
GRANT CONNECT ON DATABASE treestroke TO treestroke;
END
